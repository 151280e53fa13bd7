#include "control/design/check/latency.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::check {
namespace {

constexpr double kMostDelays = 1000;

double part_of(double latency_s, double period_s) {
  return latency_s - std::floor(latency_s / period_s) * period_s;
}

std::string unusable(const System& v, const Matrix& damping, double latency_s, double period_s) {
  std::string problem = malformed(v);
  if (problem.empty()) problem = malformed(damping, v.inputs(), "the damping");
  if (!problem.empty()) return problem;
  if (!(period_s > 0 && std::isfinite(period_s))) return "the period must be positive";
  if (!(latency_s >= 0 && latency_s <= kMostDelays * period_s))
    return "the latency must be between zero and 1000 periods";
  if (!positive_definite(damping)) return "the damping is not positive definite";
  return {};
}

}  // namespace

double spring_needs_damping(double stiffness, double latency_s, double period_s) {
  const double p = 0.5 * period_s + latency_s, t = part_of(latency_s, period_s);
  return 0.5 * stiffness * (p + std::sqrt(p * p + t * (period_s - t)));
}

double passive_scene_needs_damping(double stiffness, double damper, double latency_s,
                                   double period_s) {
  const double a = 0.5 * stiffness * period_s, both = a + damper;
  if (!(a > 0 && both > 0 && latency_s >= 0 && latency_s <= period_s))
    return std::numeric_limits<double>::quiet_NaN();
  // (c0 + c1 u)(d0 + d1 u) / (2 T (a + B)).
  const double c0 = period_s + latency_s, c1 = 2 * latency_s;
  const double d0 = both * both + a * a, d1 = a * a - both * both;
  const auto need = [&](double u) { return (c0 + c1 * u) * (d0 + d1 * u) / (2 * period_s * both); };
  double most = std::max(need(-1), need(1));
  if (c1 * d1 < 0) {
    const double top = -(c0 * d1 + c1 * d0) / (2 * c1 * d1);
    if (top > -1 && top < 1) most = std::max(most, need(top));
  }
  return most;
}

System latency_compliance(const Matrix& damping, double latency_s, double period_s) {
  const Eigen::Index m = damping.rows();
  const Matrix step = 0.5 * period_s * damping.llt().solve(Matrix::Identity(m, m));
  const int whole = static_cast<int>(std::floor(latency_s / period_s));
  const double share = part_of(latency_s, period_s) / period_s;
  const int delays = whole + (share > 0 ? 1 : 0);
  System kappa = constant(step);
  kappa.A = Matrix::Zero(m * delays, m * delays);
  kappa.B = Matrix::Zero(m * delays, m);
  kappa.C = Matrix::Zero(m, m * delays);
  for (int i = 0; i < delays; ++i) {
    if (i == 0)
      kappa.B.topRows(m).setIdentity();
    else
      kappa.A.block(m * i, m * (i - 1), m, m).setIdentity();
    kappa.C.middleCols(m * i, m) = (i < whole ? 1.0 : share) * step;
  }
  return kappa;
}

Premises passive_scene_premises(const System& v, const Matrix& damping, double latency_s,
                                double period_s) {
  Premises premises;
  premises.problem = unusable(v, damping, latency_s, period_s);
  if (!premises.problem.empty()) return premises;
  const System x = sum(v, scaled(latency_compliance(damping, latency_s, period_s), -1));
  const Rest still = rest(x);
  premises.problem = still.problem;
  if (!premises.problem.empty()) {
    premises.problem = "of V less the latency's share: " + premises.problem;
    return premises;
  }
  // Im(sigma) times the skew part would outweigh everything near rest; rest() allows rounding only.
  Dissipation& d = premises.inequality;
  d.A = x.A;
  d.B = 2 * still.x;
  d.error_B = 2 * still.error_x;
  d.S = 0.5 * x.C;
  d.R = still.gain;
  d.error_R = still.error_gain;
  d.Y = Matrix(0, x.states());
  return premises;
}

Verdict proves_passive_scenes(const System& v, const Matrix& damping, double latency_s,
                              double period_s, const Matrix& P) {
  const Premises premises = passive_scene_premises(v, damping, latency_s, period_s);
  if (!premises.problem.empty())
    return {false, premises.problem, -std::numeric_limits<double>::infinity()};
  return proves(premises.inequality, P);
}

double passive_scene_margin(const System& v, const Matrix& damping, double latency_s,
                            double period_s) {
  const Premises premises = passive_scene_premises(v, damping, latency_s, period_s);
  if (!premises.problem.empty()) {
    const bool readable = unusable(v, damping, latency_s, period_s).empty();
    return readable ? -std::numeric_limits<double>::infinity()
                    : std::numeric_limits<double>::quiet_NaN();
  }
  const Dissipation& d = premises.inequality;
  return input_level({d.A, d.B, 2 * d.S, d.R});
}

}  // namespace hapticd::check
