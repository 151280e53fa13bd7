// One axis under held force: against closed forms, against small steps, and in what friction may do.
#include "control/identify/motion.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/identify/bench_axis.h"

namespace hapticd::identify {
namespace {

Motion sliding(double velocity) {
  return {.position = 0, .velocity = velocity, .friction = std::copysign(1.0, velocity)};
}

Motion moved(const Dynamics& axis, double length_s, double force, Motion motion) {
  advance(axis, interval(axis, length_s), force, motion);
  return motion;
}

TEST(AxisMotion, DampedMassFollowsTheExponential) {
  for (const double h : {1e-6, 1e-4, 1e-3, 0.05, 2.0}) {
    const Motion after = moved({.mass = 0.01, .viscous = 0.22}, h, 0.5, sliding(1));
    const long double tau = 0.01L / 0.22L, w = 0.5L / 0.22L, decay = expm1l(-h / tau);
    EXPECT_NEAR(after.position, static_cast<double>(w * h - (1 - w) * tau * decay),
                1e-15 + 1e-12 * h);
    EXPECT_NEAR(after.velocity, static_cast<double>(1 + (1 - w) * decay), 1e-12);
  }
}

TEST(AxisMotion, LengthOfTheIntervalsDoesNotMatter) {
  const Dynamics axis{.mass = 0.05, .viscous = 1.3, .coulomb = 0.2};
  test::Draw draw(5);
  for (int i = 0; i < 2000; ++i) {
    const double force = draw.between(-1, 1), h = draw.between(1e-5, 0.05);
    const Motion start = sliding(draw.between(-0.5, 0.5));
    const Motion once = moved(axis, h, force, start);
    Motion often = start;
    for (int part = 0; part < 7; ++part) often = moved(axis, h / 7, force, often);
    EXPECT_NEAR(once.position, often.position, 1e-14);
    EXPECT_NEAR(once.velocity, often.velocity, 1e-12);
  }
}

TEST(AxisMotion, AnAxisThatFrictionHoldsStaysAtRest) {
  const Dynamics axis{.mass = 0.05, .viscous = 1, .coulomb = 0.2};
  const Motion stopped = moved(axis, 1, 0.15, sliding(0.3));
  EXPECT_EQ(stopped.velocity, 0);
  EXPECT_EQ(stopped.friction, 0);
  EXPECT_EQ(moved(axis, 1, 0.2, stopped).position, stopped.position);
  EXPECT_GT(moved(axis, 1, 0.201, stopped).position, stopped.position);
}

// Without viscous friction it comes to rest after v^2 m / (2 (F + c)), and starts back at (F - c)/m.
TEST(AxisMotion, TurningRoundIsExact) {
  const Dynamics axis{.mass = 0.1, .coulomb = 0.5};
  const double rest_s = 0.1 * 2 / 1.5, way = 0.1 * 4 / (2 * 1.5);
  const Motion after = moved(axis, rest_s + 0.2, -1, sliding(2));
  EXPECT_NEAR(after.position, way - 0.5 * (0.5 / 0.1) * 0.04, 1e-14);
  EXPECT_NEAR(after.velocity, -(0.5 / 0.1) * 0.2, 1e-13);
}

// A lag of friction gives the motion 2 c lag of impulse in its new direction.
TEST(AxisMotion, FrictionThatLagsLetsItTurnRoundFaster) {
  Dynamics axis{.mass = 0.1, .coulomb = 0.5};
  const double prompt = moved(axis, 1, -1, sliding(2)).velocity;
  for (const double lag_s : {-1e-4, 1e-4}) {
    axis.lag_s = lag_s;
    const double late = moved(axis, 1, -1, sliding(2)).velocity;
    EXPECT_NEAR((late - prompt) * 0.1, -2 * 0.5 * lag_s, 1e-12);
  }
}

}  // namespace
}  // namespace hapticd::identify
