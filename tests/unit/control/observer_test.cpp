// The recursion of the observer, against closed forms and figures computed elsewhere.
#include "control/observer/observer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "tests/support/observed_loop.h"

namespace hapticd::control {
namespace {

using build::ObserverMode;
using test::kPeriod_s;
using test::paper_observer;

/// Estimates of a device at rest that 0.5 N pushes from tick 0 on while nothing is commanded:
/// x_k = f (k T)^2 / (2 m), so the first residual is half the force and all others are the force.
std::vector<double> estimates(ObserverPlan plan, int ticks) {
  plan.damping = 0;
  ObserverState state;
  std::vector<double> result;
  for (int k = 0; k <= ticks; ++k) {
    const double t = k * kPeriod_s;
    observe(plan, state, k == 0 ? Motion::reseeded : Motion::advanced, 0.5 * t * t / (2 * 0.01), 0,
            0);
    result.push_back(state.s2);
  }
  return result;
}

ObserverPlan classic(double cutoff_Hz, int order) {
  return build::observer(0, 0, paper_observer(ObserverMode::classic, cutoff_Hz, order), kPeriod_s);
}

TEST(Observer, EstimateOfAConstantForceIsTheGeometricSeries) {
  const double a = 0.0608986326;
  EXPECT_NEAR(classic(10, 1).share, a, 1e-10);
  const std::vector<double> found = estimates(classic(10, 1), 200);
  EXPECT_EQ(found[0], 0.0);
  EXPECT_NEAR(found[1], 0.015224658, 1e-9);
  EXPECT_NEAR(found[2], 0.044746814, 1e-9);
  EXPECT_NEAR(found[5], 0.12295741, 5e-9);
  EXPECT_NEAR(found[20], 0.35308115, 5e-9);
  const double share = -std::expm1(-2 * M_PI * 10 * kPeriod_s);
  for (int k = 1; k <= 200; ++k) {
    const double expected = 0.5 - (0.5 - share * 0.25) * std::pow(1 - share, k - 1);
    ASSERT_NEAR(found[static_cast<std::size_t>(k)], expected, 1e-11) << k;
  }
}

// Two equal lags answer a step by 1 - (1 + k a) (1 - a)^k after k ticks; the first residual is half.
TEST(Observer, SecondOrderIsTwoEqualLags) {
  const std::vector<double> found = estimates(classic(10, 2), 500);
  const double a = -std::expm1(-2 * M_PI * 10 * kPeriod_s);
  const auto step = [&](int k) { return k <= 0 ? 0 : 1 - (1 + k * a) * std::pow(1 - a, k); };
  for (int k = 0; k <= 500; ++k) {
    ASSERT_NEAR(found[static_cast<std::size_t>(k)], 0.25 * (step(k) + step(k - 1)), 1e-11) << k;
  }
}

TEST(Observer, FirstOrderHasExactlyOneLag) {
  ObserverState state;
  const ObserverPlan plan = classic(37, 1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> position(-1, 1);
  observe(plan, state, Motion::reseeded, 0, 0, 0);
  for (int k = 0; k < 1000; ++k) {
    observe(plan, state, Motion::advanced, position(random), 0, 0);
    ASSERT_EQ(state.s2, state.s1);
  }
}

// A command that arrives n ticks late moves the device n ticks later: with the delay in the plan
// the residual stays zero, without it it does not.
TEST(Observer, CommandIsComparedWithTheMotionThatItMade) {
  const std::uint16_t delays[] = {0, 1, 3, 14};
  for (const std::uint16_t told : delays) {
    for (const std::uint16_t real : delays) {
      ObserverPlan plan = classic(10, 1);
      plan.damping = 0;
      plan.extra_delay = told;
      ObserverState state;
      test::HeldMass plant{.mass_kg = 0.01};
      std::vector<double> sent(20, 0.0);
      double worst = 0;
      for (int k = 0; k < 60; ++k) {
        observe(plan, state, k == 0 ? Motion::reseeded : Motion::advanced, plant.x, sent.back(), 0);
        worst = std::max(worst, std::abs(state.residual));
        sent.push_back(std::sin(0.7 * k));
        plant.advance(sent[sent.size() - 1 - real], kPeriod_s);
      }
      if (told == real) {
        EXPECT_LT(worst, 1e-9) << told;
      } else {
        EXPECT_GT(worst, 0.1) << told << " instead of " << real;
      }
    }
  }
}

TEST(Observer, HandIsTheMeanOfTheTwoPeriodsBefore) {
  const auto figures = paper_observer(ObserverMode::sensor, 10, 1);
  const ObserverPlan plan = build::observer(0, 0, figures, kPeriod_s);
  ObserverState state;
  observe(plan, state, Motion::reseeded, 0, 0, 2);
  const double hands[] = {3, 7, -5, 11};
  const double residuals[] = {-(2 + 0) / 2.0, -(3 + 2) / 2.0, -(7 + 3) / 2.0, -(-5 + 7) / 2.0};
  for (std::size_t k = 0; k < 4; ++k) {
    observe(plan, state, Motion::advanced, 0, 0, hands[k]);
    EXPECT_EQ(state.residual, residuals[k]);
  }
}

TEST(Observer, ModelModeHearsNeitherCommandNorHand) {
  auto figures = paper_observer(ObserverMode::model, 10, 2);
  figures.mass_kg = 0.015;
  figures.damping_Ns_m = 0.03;
  const ObserverPlan plan = build::observer(0, 0, figures, kPeriod_s);
  ObserverState state;
  observe(plan, state, Motion::reseeded, 0, 7, 9);
  observe(plan, state, Motion::advanced, 1e-3, 7, 9);
  EXPECT_NEAR(state.residual, -0.005 * 1e-3 / 1e-6 - 0.008 * 1e-3 / 1e-3, 1e-12);
}

// 1 m/s: a difference over a gap of ten ticks would be a residual of 90 N, and one over two
// positions alone 10 N.
TEST(Observer, NoDifferenceIsTakenOverAGap) {
  for (const Motion gap : {Motion::reseeded, Motion::held}) {
    ObserverPlan plan = classic(10, 2);
    plan.damping = 0;
    ObserverState state;
    double x = 0;
    observe(plan, state, Motion::reseeded, x, 0, 0);
    for (int k = 0; k < 200; ++k) observe(plan, state, Motion::advanced, x += 1e-3, 0, 0);
    const double kept = state.s2;
    ASSERT_NE(kept, 0.0);
    x += 10e-3;
    observe(plan, state, gap, x, 0, 0);
    EXPECT_EQ(state.s2, kept);
    if (gap == Motion::held) observe(plan, state, Motion::reseeded, x += 1e-3, 0, 0);
    observe(plan, state, Motion::advanced, x += 1e-3, 0, 0);
    EXPECT_EQ(state.s2, kept) << "two positions are known, a residual needs three";
    observe(plan, state, Motion::advanced, x += 1e-3, 0, 0);
    EXPECT_NEAR(state.residual, 0, 1e-9);
    EXPECT_NE(state.s2, kept);
  }
}

TEST(Observer, OutputFadesInFromAColdStartOnly) {
  ObserverPlan plan = classic(100, 1);
  plan.damping = 0;
  plan.blend_per_tick = 0.125;
  ObserverState state;
  observe(plan, state, Motion::reseeded, 0, 0, 0);
  for (int k = 1; k <= 12; ++k) {
    const double output = observe(plan, state, Motion::advanced, 0, 1, 0);
    ASSERT_NEAR(output, -std::min(1.0, 0.125 * k) * state.s2, 1e-15);
  }
  observe(plan, state, Motion::reseeded, 0, 1, 0);
  EXPECT_EQ(observe(plan, state, Motion::advanced, 0, 1, 0), -state.s2) << "a gap is no cold start";
}

TEST(Observer, OutputStaysWithinItsBound) {
  ObserverPlan plan = classic(10, 1);
  plan.max_output = 0.3;
  ObserverState state;
  observe(plan, state, Motion::reseeded, 0, 0, 0);
  double output = 0;
  for (int k = 0; k < 500; ++k) output = observe(plan, state, Motion::advanced, 0, 1, 0);
  EXPECT_EQ(output, 0.3);
  for (int k = 0; k < 500; ++k) output = observe(plan, state, Motion::advanced, 0, -1, 0);
  EXPECT_EQ(output, -0.3);
}

TEST(Observer, NoNumberAtAllIsAGapAndIsForgotten) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  ObserverPlan plan = build::observer(0, 0, paper_observer(ObserverMode::sensor, 10, 2), kPeriod_s);
  plan.extra_delay = 2;
  for (const double bad : {kNan, kInfinite, -kInfinite, 1e300}) {
    for (int which = 0; which < 3; ++which) {
      ObserverState state;
      observe(plan, state, Motion::reseeded, 0, 0, 0);
      for (int k = 1; k < 50; ++k) observe(plan, state, Motion::advanced, 1e-6 * k * k, 0, 0);
      const double kept = state.s2;
      const double output = observe(plan, state, Motion::advanced, which == 0 ? bad : 0,
                                    which == 1 ? bad : 0, which == 2 ? bad : 0);
      ASSERT_TRUE(std::isfinite(output));
      for (int k = 0; k < 3; ++k) observe(plan, state, Motion::advanced, 0, 0, 0);
      EXPECT_TRUE(std::isfinite(state.s2));
      EXPECT_LT(std::abs(state.s2), 10 * std::abs(kept));
      for (int k = 0; k < 5; ++k) observe(plan, state, Motion::advanced, 0, 0, 0);
      EXPECT_EQ(state.residual, 0.0) << "it goes on as if nothing had been";
    }
  }
}

// White rounding noise of q^2/12 through (m/T^2) (1 - z^-1)^2 Q(z), as published: 10 Hz, 0.01 kg,
// encoder of `counts` on a link of 0.2 m.
TEST(Observer, QuantisationNoiseOfTheEstimate) {
  struct Row {
    double counts;
    int order;
    double rms_N;
  };
  for (const Row& row : {Row{8192, 1, 0.0385}, Row{8192, 2, 0.0017}, Row{32768, 1, 0.0098},
                         Row{32768, 2, 0.00043}, Row{131072, 1, 0.0024}, Row{131072, 2, 0.00011}}) {
    ObserverPlan plan = classic(10, row.order);
    plan.damping = 0;
    ObserverState state;
    observe(plan, state, Motion::reseeded, 0, 0, 0);
    double energy = 0;
    for (int k = 0; k < 2000; ++k) {
      observe(plan, state, Motion::advanced, k == 5 ? 1 : 0, 0, 0);
      energy += state.s2 * state.s2;
    }
    const double count_m = 0.2 * 2 * M_PI / row.counts;
    EXPECT_NEAR(std::sqrt(energy / 12) * count_m, row.rms_N, 0.05 * row.rms_N)
        << row.counts << " counts, order " << row.order;
  }
}

TEST(Observer, OneCountKicksByThePowerOfTheLag) {
  const double a = classic(10, 1).share;
  for (const int order : {1, 2}) {
    ObserverPlan plan = classic(10, order);
    plan.damping = 0;
    ObserverState state;
    observe(plan, state, Motion::reseeded, 0, 0, 0);
    observe(plan, state, Motion::advanced, 1e-6, 0, 0);
    EXPECT_NEAR(state.s2, 1e4 * 1e-6 * std::pow(a, order), 1e-14);
  }
}

}  // namespace
}  // namespace hapticd::control
