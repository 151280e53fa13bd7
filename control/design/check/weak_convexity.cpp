#include "control/design/check/weak_convexity.h"

#include <Eigen/Cholesky>
#include <limits>

#include "control/design/check/dissipation.h"

namespace hapticd::check {
namespace {

Matrix inverted(const Matrix& positive) {
  return symmetric_part(positive.llt().solve(Matrix::Identity(positive.rows(), positive.rows())));
}

/// Does (1) hold, with room for rounding?
bool carries(const Matrix& K, const Matrix& B, const Matrix& phi, const Matrix& damping,
             double period_s) {
  if (damping.size() == 0) return false;
  const Matrix level = spring_damper_level(K, B, damping, period_s);
  return level.size() > 0 && level_margin(phi, level, damping) > 1e-12 * damping.norm();
}

}  // namespace

Matrix spring_damper_level(const Matrix& K, const Matrix& B, const Matrix& damping,
                           double period_s) {
  if (!positive_definite(symmetric_part(K)) ||
      !(smallest_eigenvalue(symmetric_part(B)) >= -1e-12 * B.norm()))
    return {};
  const Matrix yields = inverted(K), rest = yields - 0.5 * period_s * inverted(damping);
  if (!positive_definite(symmetric_part(rest)) ||
      !positive_definite(symmetric_part(damping - 0.5 * period_s * K - B)))
    return {};
  const Matrix n = inverted(rest);
  return symmetric_part(0.5 * period_s * n + n * yields * B * yields * n);
}

double level_margin(const Matrix& phi, const Matrix& level, const Matrix& damping) {
  return smallest_eigenvalue(symmetric_part(inverted(inverted(damping) + inverted(level)) - phi));
}

double share_with_level(const Matrix& K, const Matrix& B, const Matrix& phi,
                        const std::function<Matrix(double)>& damping, double period_s) {
  constexpr double kMost = 1e6;
  double fails = 0, holds = 1;
  while (!carries(K, B, phi, damping(holds), period_s)) {
    fails = holds;
    holds *= 2;
    if (holds > kMost) return std::numeric_limits<double>::infinity();
  }
  while (holds - fails > 1e-10 * holds) {
    const double middle = 0.5 * (holds + fails);
    (carries(K, B, phi, damping(middle), period_s) ? holds : fails) = middle;
  }
  return holds;
}

}  // namespace hapticd::check
