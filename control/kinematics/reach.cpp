#include "control/kinematics/reach.h"

#include <algorithm>
#include <cmath>

namespace hapticd::control {
namespace {

using Gram = std::array<std::array<double, 3>, 3>;

/// J J', filled up with zeros.
Gram gram_of(const Linkage& at, const double* jacobian) noexcept {
  Gram gram{};
  for (std::size_t a = 0; a < at.coordinates; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      const double *row_a = jacobian + a * at.axes, *row_b = jacobian + b * at.axes;
      double sum = 0;
      for (std::size_t j = 0; j < at.axes; ++j) sum += row_a[j] * row_b[j];
      gram[a][b] = gram[b][a] = sum;
    }
  }
  return gram;
}

/// kappa^2 = e_1 e_{n-1} / e_n with n singular values and e_k the elementary symmetric polynomials
/// of their squares: e_1 = trace, e_2 = sum of the principal minors of two rows, e_3 = determinant.
/// Zeros, be they filled up or of the larger of J J' and J' J, change none of them.
double condition_squared(const Gram& g, std::size_t n) noexcept {
  const double minor0 = g[1][1] * g[2][2] - g[1][2] * g[1][2];
  const double minor1 = g[0][0] * g[2][2] - g[0][2] * g[0][2];
  const double minor2 = g[0][0] * g[1][1] - g[0][1] * g[0][1];
  const double det = g[0][0] * minor0 - g[0][1] * (g[0][1] * g[2][2] - g[1][2] * g[0][2]) +
                     g[0][2] * (g[0][1] * g[1][2] - g[1][1] * g[0][2]);
  const std::array<double, 4> e = {1, g[0][0] + g[1][1] + g[2][2], minor0 + minor1 + minor2, det};
  return e[n] > 0 ? e[1] * e[n - 1] / e[n] : HUGE_VAL;
}

}  // namespace

double reach_of(const Linkage& at, const double* jacobian) noexcept {
  const std::size_t n = std::min(at.axes, at.coordinates);
  const double kappa2 = condition_squared(gram_of(at, jacobian), n);
  const double max2 = at.max_condition * at.max_condition;
  if (4 * kappa2 <= max2) return 1;
  if (!(kappa2 < max2)) return 0;
  return 2 - 2 * std::sqrt(kappa2 / max2);
}

}  // namespace hapticd::control
