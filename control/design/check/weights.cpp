#include "control/design/check/weights.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace hapticd::check {
namespace {

/// Largest product t (T - t) of any latency up to `latency`, t its part beyond whole periods.
double jitter(double latency, double period) {
  if (latency >= 0.5 * period) return 0.25 * period * period;
  return latency * (period - latency);
}

/// Q(r) = (1 + 4 theta r) (r G + (1 - r) X), r = (1 + u)/2, up to its factor T/2.
struct ByTheoremB {
  Eigen::MatrixXd G, X;
  double theta;
  Eigen::MatrixXd at(double r) const { return (1 + 4 * theta * r) * (r * G + (1 - r) * X); }
  /// The polar form: at(r) on the diagonal, its middle Bernstein coefficient on [r, s].
  Eigen::MatrixXd between(double r, double s) const {
    const double mean = 0.5 * (r + s), product = r * s;
    return (1 - mean) * X + mean * G + 4 * theta * ((mean - product) * X + product * G);
  }
};

}  // namespace

double direct_weight(double latency_s, double period_s) {
  const double p = 0.5 * period_s + latency_s;
  return 0.5 * (p + std::sqrt(p * p + jitter(latency_s, period_s)));
}

double coupled_weight(double latency_s, double period_s) {
  const double p = 0.5 * period_s + 1.5 * latency_s;
  return 0.5 * (p + std::sqrt(p * p + 2 * jitter(latency_s, period_s)));
}

double sharpness(double latency_s, double period_s, double rate) {
  const double share = latency_s / period_s;
  return share + share * (period_s - latency_s) * rate;
}

std::vector<Eigen::MatrixXd> passive_scene_demands(const Eigen::MatrixXd& K,
                                                   const Eigen::MatrixXd& B, double latency_s,
                                                   double period_s) {
  constexpr int kIntervals = 16;
  ByTheoremB q{.G = {}, .X = K + 2 / period_s * B, .theta = latency_s / period_s};
  const Eigen::LLT<Eigen::MatrixXd> factor(q.X);
  if (factor.info() != Eigen::Success || !q.X.allFinite()) return {};
  const Eigen::MatrixXd half = factor.matrixL().solve(K);
  q.G = half.transpose() * half;
  const int intervals = latency_s > 0 ? kIntervals : 1;
  std::vector<Eigen::MatrixXd> demands;
  for (int i = 0; i <= intervals; ++i) {
    const double r = static_cast<double>(i) / intervals;
    demands.push_back(0.5 * period_s * q.at(r));
    if (i < intervals && latency_s > 0)
      demands.push_back(0.5 * period_s * q.between(r, r + 1.0 / intervals));
  }
  return demands;
}

}  // namespace hapticd::check
