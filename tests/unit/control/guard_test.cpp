#include "control/guard/guard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;
using test::spec_of;
using test::wall;

build::ProgramSpec wall_spec(double stiffness, double damping = 0) {
  auto spec = spec_of(1);
  spec.planes = {wall(stiffness, damping)};
  return spec;
}

TEST(Guard, NoForceBeforeItIsEnabled) {
  Rig rig(wall_spec(1000));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(rig.at(-0.005).effort[0], 0.0);
  EXPECT_NEAR(rig.program.state().scene_force[0], 5.0, 1e-12)
      << "what would be felt is still computed";
}

TEST(Guard, ForceFadesInByTheRamp) {
  Rig rig(wall_spec(1000));
  rig.at(-0.005);
  rig.input.enable = true;
  for (int i = 1; i <= 8; ++i) {
    const TickOutput output = rig.at(-0.005);
    EXPECT_NEAR(output.effort[0], 0.625 * i, 1e-12);
    EXPECT_EQ(output.limits.has(Limit::ramp), i < 8);
  }
  EXPECT_NEAR(rig.at(-0.005).effort[0], 5.0, 1e-12);
}

TEST(Guard, ForceFadesOutBeforeItIsIdle) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.005);
  rig.input.enable = false;
  for (int i = 7; i >= 1; --i) {
    const TickOutput output = rig.at(-0.005);
    EXPECT_NEAR(output.effort[0], 0.625 * i, 1e-12);
    EXPECT_EQ(output.mode, Mode::enabled);
  }
  EXPECT_NEAR(rig.at(-0.005).effort[0], 0.0, 1e-12);
  EXPECT_EQ(rig.at(-0.005).mode, Mode::idle);
}

TEST(Guard, WaitsForEveryAxisToKnowItsPlace) {
  Rig rig(wall_spec(1000));
  rig.input.enable = true;
  EXPECT_EQ(rig.run().mode, Mode::idle) << "no sample yet";
  EXPECT_EQ(rig.run().fault.code, Fault::none);
  EXPECT_EQ(rig.at(0).mode, Mode::enabled);
}

TEST(Guard, CutsTheForceAtItsLimitAndSaysSo) {
  Rig rig(wall_spec(1000));
  const TickOutput output = rig.enable_at(-0.015);
  EXPECT_DOUBLE_EQ(output.effort[0], 10.0);
  EXPECT_TRUE(output.limits.has(Limit::force));
  EXPECT_EQ(output.fault.code, Fault::none) << "a limit is not a fault";
}

TEST(Guard, ForceLimitKeepsTheDirection) {
  auto spec = spec_of(3);
  spec.planes = {{.coordinates = 3, .normal = {0.6, 0, 0.8}, .offset = 0.1, .stiffness = 1000}};
  Rig rig(spec);
  const TickOutput output = rig.enable_at(0);
  EXPECT_NEAR(output.effort[0], 6.0, 1e-12);
  EXPECT_NEAR(output.effort[2], 8.0, 1e-12);
}

TEST(Guard, SlewLimitBoundsTheChangePerTick) {
  auto spec = wall_spec(1000);
  spec.devices[0].max_slew = 0.25;
  Rig rig(spec);
  rig.enable_at(0);
  double last = 0;
  for (int i = 0; i < 10; ++i) {
    const TickOutput output = rig.at(-0.0015);
    EXPECT_LE(std::abs(output.effort[0] - last), 0.25 + 1e-12);
    EXPECT_EQ(output.limits.has(Limit::slew), i < 5) << i;
    last = output.effort[0];
  }
  EXPECT_NEAR(last, 1.5, 1e-12);
}

TEST(Guard, ActuatorSaturatesWhereTheForceLimitIsTooHigh) {
  auto spec = wall_spec(1000);
  spec.axes[0].max_effort = 3;
  Rig rig(spec);
  const TickOutput output = rig.enable_at(-0.005);
  EXPECT_EQ(output.effort[0], 3.0);
  EXPECT_TRUE(output.limits.has(Limit::actuator));
}

TEST(Guard, TooFastEndsInZeroForceInThatTick) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.005);
  const TickOutput output = rig.at(-0.0075);
  EXPECT_EQ(output.effort[0], 0.0);
  EXPECT_EQ(output.mode, Mode::fault);
  EXPECT_EQ(output.fault.code, Fault::velocity);
  EXPECT_EQ(output.fault.axis, 0);
  EXPECT_NEAR(output.fault.found, 2.5, 1e-9);
  EXPECT_EQ(output.fault.allowed, 2.0);
}

TEST(Guard, MovingAPowerlessDeviceFastIsNoFault) {
  Rig rig(wall_spec(1000));
  rig.at(0);
  EXPECT_EQ(rig.at(0.005).fault.code, Fault::none);
}

TEST(Guard, EncoderJumpIsNamed) {
  Rig rig(wall_spec(1000));
  rig.enable_at(0);
  EXPECT_EQ(rig.at(0.021).fault.code, Fault::encoder_jump);
}

TEST(Guard, MissingSamplesBeyondTheLimitAreAFault) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.005);
  rig.samples[0].freshness = Freshness::missing;
  for (int i = 0; i < 3; ++i) EXPECT_GT(rig.run().effort[0], 1.0) << "held, then fading";
  const TickOutput output = rig.run();
  EXPECT_EQ(output.fault.code, Fault::sample_missing);
  EXPECT_EQ(output.effort[0], 0.0);
}

TEST(Guard, RepeatedSampleCountsAsStale) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.005);
  rig.samples[0].freshness = Freshness::repeated;
  TickOutput output;
  for (int i = 0; i < 4; ++i) output = rig.run();
  EXPECT_EQ(output.fault.code, Fault::sample_missing);
}

TEST(Guard, StuckEncoderUnderForceIsAFaultOnlyWhereWatched) {
  auto spec = wall_spec(1000);
  Rig unwatched(spec);
  unwatched.enable_at(-0.005);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(unwatched.at(-0.005).fault.code, Fault::none);

  spec.stuck_watches = {{.axis = 0, .ticks = 50, .min_effort = 1}};
  Rig rig(spec);
  rig.enable_at(-0.005);
  TickOutput output;
  for (int i = 0; i < 60; ++i) output = rig.at(-0.005);
  EXPECT_EQ(output.fault.code, Fault::encoder_stuck);
  EXPECT_NEAR(output.fault.allowed, 0.05, 1e-12);
}

TEST(Guard, EmergencyStopCutsAtOnceInAnyMode) {
  Rig rig(wall_spec(1000));
  rig.at(0);
  rig.input.host_fault = {.code = Fault::estop};
  EXPECT_EQ(rig.at(0).mode, Mode::fault) << "kept while idle too";
  rig.input.host_fault = {.code = Fault::none};
  rig.input.clear_fault = true;
  EXPECT_EQ(rig.at(0).mode, Mode::idle);
  rig.enable_at(-0.005);
  rig.input.host_fault = {.code = Fault::estop};
  EXPECT_EQ(rig.at(-0.005).effort[0], 0.0);
}

TEST(Guard, LateLoopWhileIdleIsNoFault) {
  Rig rig(wall_spec(1000));
  rig.at(0);
  rig.input.host_fault = {.code = Fault::overrun};
  EXPECT_EQ(rig.at(0).mode, Mode::idle);
}

TEST(Guard, FaultStaysUntilItIsClearedAndItsCauseIsGone) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.005);
  rig.input.host_fault = {.code = Fault::overrun};
  rig.at(-0.005);
  rig.input.clear_fault = true;
  EXPECT_EQ(rig.at(-0.005).mode, Mode::fault) << "the cause stands";
  rig.input.host_fault = {.code = Fault::none};
  for (int i = 0; i < 5; ++i) EXPECT_EQ(rig.at(-0.005).mode, Mode::fault) << "nobody cleared it";
  rig.input.clear_fault = true;
  const TickOutput output = rig.at(-0.005);
  EXPECT_EQ(output.mode, Mode::enabled);
  EXPECT_NEAR(output.effort[0], 0.625, 1e-12) << "from the foot of the ramp: no kick";
  EXPECT_EQ(output.fault.code, Fault::none);
}

TEST(Guard, FirstFaultOfATickIsTheOneReported) {
  auto spec = wall_spec(1000);
  Rig rig(spec);
  rig.enable_at(-0.005);
  rig.samples[0].raw = std::numeric_limits<double>::infinity();
  EXPECT_EQ(rig.again().fault.code, Fault::input_not_finite);
  rig.samples[0].raw = Rig::raw(0.019);
  EXPECT_EQ(rig.again().fault.code, Fault::input_not_finite) << "a later one does not hide it";
}

TEST(Guard, NotANumberInTheForceIsCaughtAtTheEnd) {
  auto spec = wall_spec(std::numeric_limits<double>::quiet_NaN());
  Rig rig(spec);
  const TickOutput output = rig.enable_at(-0.005);
  EXPECT_EQ(output.fault.code, Fault::output_not_finite);
  EXPECT_EQ(output.effort[0], 0.0);
}

TEST(Guard, SwappedPlanThatWouldStepTheForceFadesInsteadOfStepping) {
  auto soft = wall_spec(1000), hard = wall_spec(2000);
  soft.devices[0].max_slew = hard.devices[0].max_slew = 0.5;
  Rig rig(soft);
  rig.enable_at(-0.004);
  Rig next(hard);
  carry_over(rig.program.plan(), rig.program.state(), next.program.plan(), next.program.state());
  next.input.enable = true;
  double last = 4.0, least = 4.0;
  for (int i = 0; i < 60; ++i) {
    const double effort = next.at(-0.004).effort[0];
    ASSERT_LE(std::abs(effort - last), 0.5 + 1e-12) << i;
    last = effort;
    least = std::min(least, effort);
  }
  EXPECT_LT(least, 3.5) << "faded out before the new force fades in";
  EXPECT_NEAR(last, 8.0, 1e-12);
}

TEST(Guard, SwappedPlanThatFeelsTheSameDoesNotFade) {
  auto spec = wall_spec(1000);
  Rig rig(spec);
  rig.enable_at(-0.004);
  Rig next(spec);
  carry_over(rig.program.plan(), rig.program.state(), next.program.plan(), next.program.state());
  next.input.enable = true;
  const TickOutput output = next.at(-0.004);
  EXPECT_NEAR(output.effort[0], 4.0, 1e-12);
  EXPECT_EQ(output.mode, Mode::enabled);
}

}  // namespace
}  // namespace hapticd::control
