// Extremes over frequency of a function of one real variable, the angle w T of z = exp(j w T).
//
// The grid has points at and around the angle of each pole, spaced by the pole's distance from the
// unit circle, so that no resonance falls between its points however lightly it is damped; each
// local extreme is then refined by golden section. A sweep is no proof: it is what the proofs are
// held against, and what numbers without a proof (a margin in N s/m) are made from.
#pragma once
#include <functional>
#include <vector>

#include "control/design/check/linear.h"

namespace hapticd::check {

/// Angles in [0, pi], ascending, both ends included, for a function whose poles are the eigenvalues
/// of `a` (and, if there is a second matrix, of that).
std::vector<double> frequency_grid(const Matrix& a, std::size_t points = 240);

struct Extreme {
  double value = 0;  ///< NaN where the function is NaN anywhere on the grid
  double angle = 0;  ///< rad
};
Extreme smallest(const std::function<double(double)>& function, const std::vector<double>& grid);
Extreme largest(const std::function<double(double)>& function, const std::vector<double>& grid);

inline Complex on_circle(double angle) {
  return std::polar(1.0, angle);
}

}  // namespace hapticd::check
