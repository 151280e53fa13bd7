#include "control/design/synthesis/one_variable.h"

#include <cmath>
#include <limits>
#include <vector>

namespace hapticd::synthesis {
namespace {

double point(const Scan& scan, int i) {
  return scan.low * std::pow(scan.high / scan.low, static_cast<double>(i) / (scan.points - 1));
}

/// The border between `inside`, where it holds, and `outside`.
double border(const std::function<bool(double)>& holds, double inside, double outside) {
  while (std::abs(outside - inside) > 1e-10 * inside) {
    const double middle = 0.5 * (inside + outside);
    (holds(middle) ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace

std::optional<Range> where(const std::function<bool(double)>& holds, const Scan& scan) {
  int best_first = 0, best_size = 0, first = 0, size = 0;
  for (int i = 0; i < scan.points; ++i) {
    size = holds(point(scan, i)) ? size + 1 : 0;
    if (size == 1) first = i;
    if (size > best_size) best_first = first, best_size = size;
  }
  if (best_size == 0) return std::nullopt;
  const int last = best_first + best_size - 1;
  Range range{point(scan, best_first), point(scan, last)};
  if (best_first > 0) range.low = border(holds, range.low, point(scan, best_first - 1));
  if (last < scan.points - 1) range.high = border(holds, range.high, point(scan, last + 1));
  return range;
}

Least least(const std::function<double(double)>& function, const Scan& scan) {
  Least best{scan.low, std::numeric_limits<double>::infinity()};
  int index = 0;
  for (int i = 0; i < scan.points; ++i) {
    const double x = point(scan, i), value = function(x);
    if (value < best.value) best = {x, value}, index = i;
  }
  if (!std::isfinite(best.value)) return best;
  const double ratio = 0.5 * (std::sqrt(5.0) - 1);
  double left = point(scan, index > 0 ? index - 1 : 0);
  double right = point(scan, index + 1 < scan.points ? index + 1 : index);
  double a = right - ratio * (right - left), b = left + ratio * (right - left);
  double fa = function(a), fb = function(b);
  while (right - left > 1e-9 * right) {
    if (fa < fb) {
      right = b, b = a, fb = fa;
      fa = function(a = right - ratio * (right - left));
    } else {
      left = a, a = b, fa = fb;
      fb = function(b = left + ratio * (right - left));
    }
  }
  if (fa < best.value) best = {a, fa};
  if (fb < best.value) best = {b, fb};
  return best;
}

double sign_change(const std::function<double(double)>& function, double low, double high) {
  while (high - low > 1e-13 * high) {
    const double middle = 0.5 * (low + high);
    if (middle <= low || middle >= high) break;
    (function(middle) < 0 ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace hapticd::synthesis
