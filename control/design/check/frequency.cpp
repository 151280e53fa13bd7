#include "control/design/check/frequency.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hapticd::check {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr std::size_t kRefined = 40;  ///< local extremes that are refined, the best first
constexpr double kSlowest = 1e-7;     ///< rad: below it nothing is looked for but at 0

/// Points around a pole, in widths of its resonance: close together where it peaks.
void add_around(std::vector<double>& grid, Complex pole) {
  const double angle = std::abs(std::arg(pole));
  const double width = std::max(std::abs(1 - std::abs(pole)), 1e-13);
  for (double step = 0.25; step < 300; step *= 1.5) {
    grid.push_back(angle + step * width);
    grid.push_back(angle - step * width);
  }
  grid.push_back(angle);
}

/// Minimum within [left, right] of a function that has one there.
Extreme golden(const std::function<double(double)>& f, double left, double right) {
  const double ratio = 0.5 * (std::sqrt(5.0) - 1);
  double a = right - ratio * (right - left), b = left + ratio * (right - left);
  double fa = f(a), fb = f(b);
  for (int i = 0; i < 60 && right - left > 1e-13 * right; ++i) {
    if (fa < fb) {
      right = b;
      b = a;
      fb = fa;
      a = right - ratio * (right - left);
      fa = f(a);
    } else {
      left = a;
      a = b;
      fa = fb;
      b = left + ratio * (right - left);
      fb = f(b);
    }
  }
  return fa < fb ? Extreme{fa, a} : Extreme{fb, b};
}

}  // namespace

std::vector<double> frequency_grid(const Matrix& a, std::size_t points) {
  std::vector<double> grid{0, kPi};
  const double decades = std::log(kPi / kSlowest);
  for (std::size_t i = 0; i < points; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(points);
    grid.push_back(kPi * share);
    grid.push_back(kPi * std::exp(-decades * share));
  }
  if (a.size() > 0 && a.allFinite()) {
    const Eigen::VectorXcd poles = eigenvalues(a);
    for (const Complex& pole : poles) add_around(grid, pole);
  }
  for (double& angle : grid) angle = angle > kPi ? 2 * kPi - angle : std::abs(angle);
  std::erase_if(grid, [](double angle) { return !(angle >= 0 && angle <= kPi); });
  std::sort(grid.begin(), grid.end());
  grid.erase(std::unique(grid.begin(), grid.end()), grid.end());
  return grid;
}

Extreme smallest(const std::function<double(double)>& function, const std::vector<double>& grid) {
  std::vector<double> values;
  values.reserve(grid.size());
  Extreme best{std::numeric_limits<double>::infinity(), 0};
  for (const double angle : grid) {
    values.push_back(function(angle));
    if (std::isnan(values.back())) return {values.back(), angle};
    if (values.back() < best.value) best = {values.back(), angle};
  }
  const std::size_t last = grid.size() - 1;
  std::vector<std::size_t> valleys;
  for (std::size_t i = 0; i <= last; ++i) {
    const bool falls = i == 0 || values[i] <= values[i - 1];
    const bool rises = i == last || values[i] <= values[i + 1];
    if (falls && rises) valleys.push_back(i);
  }
  std::stable_sort(valleys.begin(), valleys.end(),
                   [&](std::size_t i, std::size_t j) { return values[i] < values[j]; });
  if (valleys.size() > kRefined) valleys.resize(kRefined);
  for (const std::size_t i : valleys) {
    const Extreme refined = golden(function, grid[i == 0 ? 0 : i - 1], grid[std::min(i + 1, last)]);
    if (std::isnan(refined.value)) return refined;
    if (refined.value < best.value) best = refined;
  }
  return best;
}

Extreme largest(const std::function<double(double)>& function, const std::vector<double>& grid) {
  Extreme extreme = smallest([&](double angle) { return -function(angle); }, grid);
  extreme.value = -extreme.value;
  return extreme;
}

}  // namespace hapticd::check
