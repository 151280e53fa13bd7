// Searches over one number: where a condition holds, and where a function is least. What they look
// at first is a grid of `points`, evenly spaced in the logarithm of x: narrower things may be missed,
// as in any search by values alone.
#pragma once
#include <functional>
#include <optional>

namespace hapticd::synthesis {

struct Range {
  double low = 0, high = 0;
};
/// 0 < low < high.
struct Scan {
  double low = 0.01, high = 100;
  int points = 80;
};

/// The longest run of the grid on which `holds`, its ends bisected to 1e-10 of themselves; an end of
/// the scan where it holds there. Nothing where it holds nowhere on the grid.
std::optional<Range> where(const std::function<bool(double)>& holds, const Scan& scan);

struct Least {
  double x = 0, value = 0;  ///< value: infinity where the function is nowhere finite
};
/// Golden section around the least value on the grid, to 1e-9 of x; infinite values are allowed.
/// Near a smooth minimum values tell x to about 1e-7 of it at best.
Least least(const std::function<double(double)>& function, const Scan& scan);

/// Where a function that is negative at `low` and positive at `high` changes its sign, to 1e-13.
double sign_change(const std::function<double(double)>& function, double low, double high);

}  // namespace hapticd::synthesis
