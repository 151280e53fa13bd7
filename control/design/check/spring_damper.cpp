#include "control/design/check/spring_damper.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

namespace hapticd::check {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Matrix inverse_of(const Matrix& symmetric) {
  return symmetric_part(
      symmetric.llt().solve(Matrix::Identity(symmetric.rows(), symmetric.cols())));
}

bool one_size(const Matrix& a, const Matrix& b, const Matrix& c) {
  const Eigen::Index m = a.rows();
  return malformed(a, m, "").empty() && malformed(b, m, "").empty() && malformed(c, m, "").empty();
}

}  // namespace

System spring_damper(const Matrix& stiffness, const Matrix& damper, double period_s) {
  const Matrix n = stiffness * period_s + damper;
  const Matrix gain = n.partialPivLu().inverse();
  const Matrix state = damper * gain;
  return {state, period_s * state, gain, period_s * gain};
}

double damping_share(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                     double period_s) {
  if (!one_size(stiffness, damper, damping) || !positive_definite(damping)) return kNone;
  const Eigen::LLT<Matrix> factor(damping);
  const Matrix half = factor.matrixL().solve(0.5 * period_s * stiffness + damper);
  return largest_eigenvalue(symmetric_part(factor.matrixL().solve(half.transpose())));
}

Matrix output_level(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                    double period_s) {
  const bool used = damping_share(stiffness, damper, damping, period_s) < 1;
  if (!used || !positive_definite(stiffness)) return {};
  if (smallest_eigenvalue(damper) < -1e-12 * damper.norm()) return {};
  const Matrix soft = inverse_of(stiffness);
  const Matrix rest_of_v = soft - 0.5 * period_s * inverse_of(damping);
  if (!positive_definite(rest_of_v)) return {};
  const Matrix inverse = inverse_of(rest_of_v);
  return symmetric_part(0.5 * period_s * inverse + inverse * soft * damper * soft * inverse);
}

double output_level(double stiffness, double damper, double damping, double period_s) {
  const double a = 0.5 * stiffness * period_s;
  const double p = 1 - a / damping;
  const double level = a / p + damper / (p * p);
  // |A_V| < 1 is 2 a + 2 B > 0.
  const bool valid = stiffness > 0 && damping > 0 && period_s > 0 && p > 0 && level > 0 &&
                     a + damper > 0 && a + damper < damping;
  return valid ? level : kNone;
}

Matrix tolerated_level(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                       double period_s) {
  const Matrix level = output_level(stiffness, damper, damping, period_s);
  if (level.size() == 0 || !positive_definite(level)) return {};
  return inverse_of(inverse_of(damping) + inverse_of(level));
}

StiffnessRange spring_range(double phi, double damping, double period_s) {
  return {2 * phi / period_s, 2 * damping / period_s};
}

}  // namespace hapticd::check
