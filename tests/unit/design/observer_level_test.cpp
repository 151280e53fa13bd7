// What an observer in mode model takes of the damping, against its own recursion.
#include "control/design/check/observer_level.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>

#include "control/build/filters.h"
#include "tests/support/period.h"

namespace hapticd::check {
namespace {

control::ObserverPlan model_observer(double lighter_kg, double less_damped, double cutoff_Hz,
                                     int order = 2) {
  return build::observer(0, 0,
                         {.mode = build::ObserverMode::model,
                          .nominal_mass_kg = 1 - lighter_kg,
                          .nominal_damping_Ns_m = 5 - less_damped,
                          .mass_kg = 1,
                          .damping_Ns_m = 5,
                          .cutoff_Hz = cutoff_Hz,
                          .order = order,
                          .max_output = 1e9},
                         test::kPeriod_s);
}

TEST(ObserverLevel, MassThatIsTakenAwayCostsWhatTheoryNames) {
  EXPECT_NEAR(observer_loss(model_observer(0.010, 0, 10), test::kPeriod_s), 0.314, 0.01);
  EXPECT_NEAR(observer_loss(model_observer(0.001, 0, 10), test::kPeriod_s), 0.0314, 0.001);
  EXPECT_NEAR(observer_loss(model_observer(0.010, 0, 3), test::kPeriod_s), 0.094, 0.002);
}

TEST(ObserverLevel, DampingThatIsTakenAwayCostsItself) {
  EXPECT_NEAR(observer_loss(model_observer(0, 0.8, 10), test::kPeriod_s), 0.8, 0.8e-3);
}

/// H by feeding the loop's observer a slow sweep is what the next one does; here by its formula.
double swept(const control::ObserverPlan& plan) {
  double most = 0;
  for (int i = 1; i <= 20000; ++i) {
    const std::complex<double> back = std::polar(1.0, -std::numbers::pi * std::pow(i / 20000.0, 3));
    const auto lag = [&](double a) { return a / (1.0 - (1 - a) * back); };
    const std::complex<double> step = 1.0 - back;
    const std::complex<double> H = lag(plan.share) * lag(plan.second_share) *
                                   (plan.inertia * step * step + plan.damping * step);
    most = std::max(most, -std::real(test::kPeriod_s * H * back / step));
  }
  return most;
}

TEST(ObserverLevel, RandomObserversLoseWhatASweepFinds) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> one(-1, 1);
  int losing = 0;
  for (int trial = 0; trial < 100; ++trial) {
    const auto plan = model_observer(0.3 * one(random), 2 * one(random),
                                     std::pow(10, 1 + one(random)), 1 + trial % 2);
    const double loss = observer_loss(plan, test::kPeriod_s), found = swept(plan);
    EXPECT_GE(loss, found - 1e-9);
    EXPECT_LE(loss, found * 1.001 + 1e-5);
    losing += found > 0.01;
  }
  EXPECT_GT(losing, 30);
}

TEST(ObserverLevel, TheRecursionOfTheLoopIsTheOneThatIsBounded) {
  // A sine long enough to settle: work per period of the observer's force on the motion.
  const control::ObserverPlan plan = model_observer(0.01, 0.1, 10);
  control::ObserverState state;
  const double omega = 2 * std::numbers::pi * 10, samples = 100;  // 10 Hz at 1 kHz
  double work = 0, squares = 0;
  for (int k = 0; k < 4000; ++k) {
    const double x = 1e-3 * std::sin(omega * test::kPeriod_s * k);
    const double next = 1e-3 * std::sin(omega * test::kPeriod_s * (k + 1));
    const double u = control::observe(plan, state, control::Motion::advanced, x, 0, 0);
    if (k < 4000 - samples) continue;
    work += u * (next - x);
    squares += (next - x) * (next - x) / test::kPeriod_s;
  }
  const double taken = work / squares;  // N s/m: as much damping it acts like a motor against
  EXPECT_GT(taken, 0.05);
  EXPECT_LE(taken, observer_loss(plan, test::kPeriod_s) * (1 + 1e-6));
}

TEST(ObserverLevel, ClassicAndSensorLeaveNone) {
  control::ObserverPlan plan = model_observer(0.01, 0, 10);
  EXPECT_FALSE(leaves_no_level(plan));
  plan.command_share = 1;
  EXPECT_TRUE(leaves_no_level(plan));
}

}  // namespace
}  // namespace hapticd::check
