#include "control/motion/estimators.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "control/build/filters.h"
#include "tests/support/period.h"
#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::kPeriod_s;

/// One axis whose position is given as it is: one raw unit is one metre.
class OneAxis {
 public:
  explicit OneAxis(build::ProgramSpec spec) : rig_(std::move(spec)) {}

  double at(double x_m, std::int64_t missed_ticks = 0) {
    rig_.samples[0].raw = x_m;
    rig_.input.missed_ticks = missed_ticks;
    rig_.again();
    return qd();
  }
  double without_sample() {
    rig_.samples[0].freshness = Freshness::missing;
    rig_.input.missed_ticks = 0;
    rig_.run();
    return qd();
  }
  double qd() const { return rig_.program.state().qd[0]; }

 private:
  test::Rig rig_;
};

build::ProgramSpec exact_axis() {
  build::ProgramSpec spec = test::spec_of(1);
  spec.axes[0] = {.unit_per_raw = 1, .max_effort = 1, .max_velocity = 1e9, .max_step = 1e9};
  return spec;
}

/// Every estimator in turn.
std::vector<build::ProgramSpec> all_kinds() {
  std::vector<build::ProgramSpec> specs(6, exact_axis());
  specs[0].low_passes = {build::low_pass(0, 100, kPeriod_s)};
  specs[1].least_squares = {build::least_squares(0, 8, 1, kPeriod_s)};
  specs[2].least_squares = {build::least_squares(0, 8, 2, kPeriod_s)};
  specs[3].least_squares = {build::least_squares(0, 32, 3, kPeriod_s)};
  specs[4].foaws = {build::foaw(0, 32, 1e-6)};
  specs[5].alpha_beta_gammas = {build::alpha_beta_gamma(0, 400, kPeriod_s)};
  return specs;
}

TEST(LeastSquares, SlopeOfItsOwnPolynomialsIsExact) {
  for (const std::uint16_t degree : {std::uint16_t{1}, std::uint16_t{2}, std::uint16_t{3}}) {
    for (std::uint16_t window = degree + 1u; window <= kMaxWindow; ++window) {
      const LeastSquaresPlan plan = build::least_squares(0, window, degree, kPeriod_s);
      for (int power = 0; power <= degree; ++power) {
        double slope = 0;
        for (int i = 0; i < window; ++i)
          slope += plan.weights[static_cast<std::size_t>(i)] * std::pow(1 - 0.01 * i, power);
        ASSERT_NEAR(slope, power * 0.01 / kPeriod_s, 1e-6) << window << ", degree " << degree;
      }
    }
  }
}

// Of all weights that are exact on those polynomials the least squares ones are the shortest: they
// lie in the span of the polynomials, so their differences of order degree + 1 vanish.
TEST(LeastSquares, WeightsAreThemselvesAPolynomialOfTheDegree) {
  for (const std::uint16_t degree : {std::uint16_t{1}, std::uint16_t{2}}) {
    const LeastSquaresPlan plan = build::least_squares(0, 16, degree, kPeriod_s);
    std::vector<double> w(plan.weights.begin(), plan.weights.begin() + 16);
    for (int order = 0; order <= degree; ++order) {
      EXPECT_GT(std::abs(w[0]), 1e-3) << "the test would be empty";
      for (std::size_t i = 0; i + 1 < w.size(); ++i) w[i] = w[i + 1] - w[i];
      w.pop_back();
    }
    for (const double difference : w) EXPECT_NEAR(difference, 0, 1e-9);
  }
}

TEST(LeastSquares, LineHasTheClosedForm) {
  for (const int n : {2, 8, 31}) {
    const auto plan = build::least_squares(0, static_cast<std::uint16_t>(n), 1, kPeriod_s);
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(plan.weights[static_cast<std::size_t>(i)],
                  12 * (0.5 * (n - 1) - i) / (kPeriod_s * n * (n * n - 1.0)), 1e-9);
    }
  }
}

TEST(LeastSquares, ParabolaThroughTheLoopIsFollowedWithoutDelay) {
  for (const int window : {3, 8, 15, 32}) {
    build::ProgramSpec spec = exact_axis();
    spec.least_squares = {
        build::least_squares(0, static_cast<std::uint16_t>(window), 2, kPeriod_s)};
    OneAxis axis(spec);
    for (int k = 0; k < 100; ++k) {
      const double t = k * kPeriod_s;
      const double found = axis.at(0.3 + 0.2 * t - 3 * t * t);
      if (k >= window) {
        ASSERT_NEAR(found, 0.2 - 6 * t, 1e-10) << window;
      }
    }
  }
}

TEST(LeastSquares, OldestStandsForWhatWasBeforeIt) {
  build::ProgramSpec spec = exact_axis();
  spec.least_squares = {build::least_squares(0, 8, 2, kPeriod_s)};
  OneAxis axis(spec);
  axis.at(1);
  axis.at(1);
  const double* w = spec.least_squares[0].weights.data();
  double expected = 0;
  for (int i = 1; i < 8; ++i) expected += w[i] * (1 - 1.25);
  EXPECT_NEAR(axis.at(1.25), expected, 1e-12);
}

TEST(LowPass, StepOfVelocityIsApproachedGeometrically) {
  OneAxis axis(all_kinds()[0]);
  axis.at(0);
  for (int k = 1; k < 50; ++k) {
    ASSERT_NEAR(axis.at(0.2e-3 * k), 0.2 * (1 - std::exp(-2 * M_PI * 100 * kPeriod_s * k)), 1e-12);
  }
}

// All three poles at r: whatever the start, with the position at rest
// v_{k+3} = 3 r v_{k+2} - 3 r^2 v_{k+1} + r^3 v_k.
TEST(AlphaBetaGamma, AllPolesAreWhereTheBandwidthPutsThem) {
  const double r = std::exp(-400 * kPeriod_s);
  OneAxis axis(all_kinds()[5]);
  axis.at(0);
  std::vector<double> v;
  for (int k = 0; k < 100; ++k) v.push_back(axis.at(1e-3));
  ASSERT_GT(std::abs(v[2]), 1e-3);
  for (std::size_t k = 0; k + 3 < v.size(); ++k)
    ASSERT_NEAR(v[k + 3], 3 * r * v[k + 2] - 3 * r * r * v[k + 1] + r * r * r * v[k], 1e-12);
}

TEST(AlphaBetaGamma, ParabolaIsFollowedWithoutDelay) {
  OneAxis axis(all_kinds()[5]);
  for (int k = 0; k < 400; ++k) axis.at(std::pow(k * kPeriod_s, 2));
  EXPECT_NEAR(axis.qd(), 2 * 399 * kPeriod_s, 1e-10);
}

/// The definition, window by window.
double longest_line(const std::vector<double>& newest_first, std::size_t window, double noise) {
  double slope = 0;
  for (std::size_t n = 1; n < std::min(window, newest_first.size()); ++n) {
    const double candidate = (newest_first[0] - newest_first[n]) / static_cast<double>(n);
    for (std::size_t i = 1; i < n; ++i) {
      const double line = newest_first[0] - static_cast<double>(i) * candidate;
      if (std::abs(line - newest_first[i]) > noise) return slope;
    }
    slope = candidate;
  }
  return slope;
}

TEST(Foaw, SlopeIsThatOfTheLongestLineThatFits) {
  std::mt19937 random(7);
  std::normal_distribution<double> kick(0, 0.3e-6);
  for (const std::uint16_t window : {std::uint16_t{2}, std::uint16_t{9}, std::uint16_t{32}}) {
    build::ProgramSpec spec = exact_axis();
    spec.foaws = {build::foaw(0, window, 1e-6)};
    OneAxis axis(spec);
    std::vector<double> newest_first;
    double x = 0, v = 0;
    for (int k = 0; k < 3000; ++k) {
      x += v += kick(random) * (k % 200 < 60 ? 1 : 0.05);
      newest_first.insert(newest_first.begin(), x);
      const double found = axis.at(x);
      ASSERT_NEAR(found * kPeriod_s, longest_line(newest_first, window, 1e-6 * (1 + 1e-9)), 1e-15);
    }
  }
}

TEST(Foaw, OneCountOfFlickerIsNoMotion) {
  build::ProgramSpec spec = exact_axis();
  spec.foaws = {build::foaw(0, 16, 1e-6)};
  OneAxis axis(spec);
  double worst = 0;
  for (int k = 0; k < 100; ++k) {
    const double found = axis.at(k % 5 == 0 ? 1e-6 : 0);
    if (k >= 16) worst = std::max(worst, std::abs(found));
  }
  EXPECT_LE(worst, 1e-6 / (15 * kPeriod_s) + 1e-12) << "the difference would say 1e-3 m/s";
}

TEST(Estimators, RestIsExactlyZeroWhereverItIs) {
  for (const build::ProgramSpec& spec : all_kinds()) {
    OneAxis axis(spec);
    for (int k = 0; k < 50; ++k) ASSERT_EQ(axis.at(123.456), 0.0);
  }
}

// 1 m away after a gap: any difference over it would be at least 1 m / 32 ms.
TEST(Estimators, NothingBeforeAGapIsRemembered) {
  for (const build::ProgramSpec& spec : all_kinds()) {
    OneAxis moved(spec), fresh(spec);
    for (int k = 0; k < 50; ++k) moved.at(0.2e-3 * k);
    ASSERT_GT(moved.qd(), 0.1);
    EXPECT_EQ(moved.at(1, 2), 0.0);
    fresh.at(1);
    for (int k = 1; k < 40; ++k) {
      const double x = 1 + 1e-4 * k * k;
      ASSERT_EQ(moved.at(x), fresh.at(x));
    }
  }
}

TEST(Estimators, VelocityStandsWhileTheSampleIsHeld) {
  for (const build::ProgramSpec& spec : all_kinds()) {
    OneAxis axis(spec);
    for (int k = 0; k < 50; ++k) axis.at(0.2e-3 * k);
    const double last = axis.qd();
    ASSERT_NE(last, 0.0);
    EXPECT_EQ(axis.without_sample(), last);
    EXPECT_EQ(axis.at(50 * 0.2e-3), 0.0) << "no difference over what was missing";
  }
}

TEST(Estimators, EveryKindSettlesOnTheSpeedOfALine) {
  for (const build::ProgramSpec& spec : all_kinds()) {
    OneAxis axis(spec);
    for (int k = 0; k < 200; ++k) axis.at(-0.3e-3 * k);
    EXPECT_NEAR(axis.qd(), -0.3, 1e-9);
  }
}

}  // namespace
}  // namespace hapticd::control
