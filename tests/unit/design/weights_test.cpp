// Latency weights against the published table, and Theorem B in matrices against the transfer
// functions themselves.
#include "control/design/check/weights.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "control/core/algebra.h"
#include "tests/support/period.h"

namespace hapticd::check {
namespace {

using Eigen::MatrixXd;
using Complex = std::complex<double>;

TEST(Weights, SpringsUnderLatencyAreThoseOfTheTheorems) {
  for (const auto& [tau, s] : {std::pair{0.0, 0.5}, {0.2, 0.89}, {0.5, 1.343}})
    EXPECT_NEAR(coupled_weight(tau * test::kPeriod_s, test::kPeriod_s), s * test::kPeriod_s,
                5e-4 * test::kPeriod_s);
  for (const auto& [tau, s] : {std::pair{0.0, 0.5}, {0.25, 0.808}, {0.5, 1.059}})
    EXPECT_NEAR(direct_weight(tau * test::kPeriod_s, test::kPeriod_s), s * test::kPeriod_s,
                5e-4 * test::kPeriod_s);
}

/// Smallest damping that K, B ask, from V and the delayed hold on a grid of frequencies, latencies
/// changing from tick to tick in [0, tau] covered: 1 - 1/z and T/2 Delta^-1 (1 + theta + theta/z).
double needed(double K, double B, double tau) {
  const double theta = tau / test::kPeriod_s;
  double most = 0;
  for (int i = 1; i <= 4000; ++i) {
    const Complex z = std::polar(1.0, std::numbers::pi * i / 4000);
    const Complex c = 1.0 - 1.0 / z, V = 1.0 / (K + B / test::kPeriod_s * c);
    const double takes = std::real(c * (1 + theta + theta / z)) * test::kPeriod_s / 2;
    most = std::max(most, takes / std::real(c * V));
  }
  return most;
}

TEST(TheoremB, OneAxisIsTheFrequencySweep) {
  int count = 0;
  for (const double tau : {0.0, 0.2e-3, 0.5e-3, 1e-3}) {
    for (const double B : {0.0, 0.05, 0.3, 1.0, -0.01}) {
      const MatrixXd K = MatrixXd::Constant(1, 1, 700), D = MatrixXd::Constant(1, 1, B);
      double most = 0;
      for (const MatrixXd& demand : passive_scene_demands(K, D, tau, test::kPeriod_s))
        most = std::max(most, demand(0, 0));
      const double swept = needed(700, B, tau);
      EXPECT_GE(most, swept * (1 - 1e-9)) << tau << " " << B;
      EXPECT_LE(most, swept * 1.01) << tau << " " << B;
      ++count;
    }
  }
  EXPECT_EQ(count, 20);
}

TEST(TheoremB, WithoutDampingAndJitterAddsToThreeHalvesOfTheLatency) {
  // A constant latency asks K (T + 3 tau)/2; one that may also be shorter, K (T + 4 tau)/2.
  const MatrixXd K = MatrixXd::Constant(1, 1, 1000);
  double most = 0;
  for (const MatrixXd& demand : passive_scene_demands(K, 0 * K, 0.5e-3, test::kPeriod_s))
    most = std::max(most, demand(0, 0));
  EXPECT_NEAR(most, 1000 * (1e-3 + 4 * 0.5e-3) / 2, 1e-3);
}

/// Smallest eigenvalue of He[(1 - 1/z)(V - takes)] over the grid, by |1 - 1/z|^2.
double least(const MatrixXd& K, const MatrixXd& B, const MatrixXd& damping, double tau) {
  const double theta = tau / test::kPeriod_s;
  double smallest = 1e300;
  for (int i = 1; i <= 400; ++i) {
    const Complex z = std::polar(1.0, std::numbers::pi * i / 400), c = 1.0 - 1.0 / z;
    const Eigen::MatrixXcd W = K.cast<Complex>() + (c / test::kPeriod_s) * B.cast<Complex>();
    const Eigen::MatrixXcd takes =
        (test::kPeriod_s / 2 * (1 + theta + theta / z)) * damping.inverse().cast<Complex>();
    const Eigen::MatrixXcd form = c * (W.inverse() - takes);
    const Eigen::MatrixXcd he = (form + form.adjoint()) / (2 * std::norm(c));
    smallest = std::min(smallest, algebra::hermitian_eigenvalues(he).minCoeff());
  }
  return smallest;
}

TEST(TheoremB, MatricesThatDoNotCommuteAreDecidedAsOnTheCircle) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  const auto gram = [&](double size) {
    const MatrixXd g = MatrixXd::NullaryExpr(3, 3, [&] { return normal(random); });
    return MatrixXd(size * (g * g.transpose() + 0.1 * MatrixXd::Identity(3, 3)));
  };
  int held = 0, failed = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const double tau = 1e-3 * (trial % 4) / 3;
    const MatrixXd K = gram(300), B = gram(0.1);
    MatrixXd damping = MatrixXd::Zero(3, 3);
    double share = 0;
    for (int i = 0; i < 3; ++i) damping(i, i) = 0.5 + std::abs(normal(random));
    const MatrixXd spread = damping.diagonal().cwiseSqrt().cwiseInverse().asDiagonal();
    for (const MatrixXd& demand : passive_scene_demands(K, B, tau, test::kPeriod_s))
      share = std::max(share, algebra::symmetric_eigenvalues(spread * demand * spread).maxCoeff());
    // The share is the scale of damping at which the form on the circle touches zero.
    EXPECT_GT(least(K, B, 1.001 * share * damping, tau), 0);
    EXPECT_LT(least(K, B, 0.98 * share * damping, tau), 0);
    (share < 1 ? held : failed)++;
  }
  EXPECT_GT(held, 3);
  EXPECT_GT(failed, 3);
}

TEST(TheoremB, NothingHoldsWhereTheCouplingRingsByItself) {
  const MatrixXd K = MatrixXd::Constant(1, 1, 100);
  EXPECT_TRUE(
      passive_scene_demands(K, MatrixXd::Constant(1, 1, -0.06), 0, test::kPeriod_s).empty());
  EXPECT_TRUE(passive_scene_demands(K, MatrixXd::Constant(1, 1, NAN), 0, test::kPeriod_s).empty());
}

}  // namespace
}  // namespace hapticd::check
