// Limits that only some devices name: power, temperature, travel, workspace, enable inputs, and the
// fade that stale samples make.
#include "control/guard/limits.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;
using test::spec_of;
using test::wall;

build::ProgramSpec wall_spec(double stiffness) {
  auto spec = spec_of(1);
  spec.planes = {wall(stiffness, 0)};
  return spec;
}

TEST(StaleSamples, HoldOnceThenFadeThenFault) {
  Rig rig(wall_spec(1000));
  ASSERT_NEAR(rig.enable_at(-0.006).effort[0], 6.0, 1e-12);
  const auto miss = [&] {
    rig.samples[0].freshness = Freshness::missing;
    return rig.run();
  };
  const TickOutput held = miss();
  EXPECT_NEAR(held.effort[0], 6.0, 1e-12);
  EXPECT_FALSE(held.limits.has(Limit::stale));
  EXPECT_NEAR(miss().effort[0], 4.0, 1e-12);
  const TickOutput third = miss();
  EXPECT_NEAR(third.effort[0], 2.0, 1e-12);
  EXPECT_TRUE(third.limits.has(Limit::stale));
  const TickOutput fourth = miss();
  EXPECT_EQ(fourth.effort[0], 0.0);
  EXPECT_EQ(fourth.fault.code, Fault::sample_missing);
}

TEST(StaleSamples, ForceComesBackNoFasterThanTheRamp) {
  Rig rig(wall_spec(1000));
  rig.enable_at(-0.006);
  for (int i = 0; i < 3; ++i) {
    rig.samples[0].freshness = Freshness::missing;
    rig.run();
  }
  double last = rig.program.state().effort[0];
  for (int i = 0; i < 5; ++i) {
    const double effort = rig.at(-0.006).effort[0];
    EXPECT_LE(effort - last, 6.0 / 8 + 1e-12);
    last = effort;
  }
  for (int i = 0; i < 5; ++i) last = rig.at(-0.006).effort[0];
  EXPECT_NEAR(last, 6.0, 1e-12);
}

TEST(Power, IsCutAtTheLimitWhenTheMotorsDrive) {
  auto spec = wall_spec(1000);
  spec.power_limits = {{.device = 0, .max_W = 0.5}};
  Rig rig(spec);
  rig.enable_at(-0.006);
  const TickOutput out = rig.at(-0.0055);  // pushed out at 0.5 m/s: 5.5 N would be 2.75 W
  EXPECT_NEAR(out.effort[0] * 0.5, 0.5, 1e-9);
  EXPECT_TRUE(out.limits.has(Limit::power));
}

TEST(Power, BrakingAHandIsNotLimited) {
  auto spec = wall_spec(1000);
  spec.power_limits = {{.device = 0, .max_W = 0.5}};
  Rig rig(spec);
  rig.enable_at(-0.005);
  const TickOutput out = rig.at(-0.006);
  EXPECT_NEAR(out.effort[0], 6.0, 1e-9);
  EXPECT_FALSE(out.limits.has(Limit::power));
}

/// h' = (u/c)^2 - h over the time constant, integrated here in steps a hundred times finer.
TEST(Temperature, HeatFollowsTheMotorsLawAndNeverPassesOne) {
  auto spec = wall_spec(1000);
  const double tau_s = 0.5;
  spec.thermals = {{.axis = 0, .continuous = 3, .share = 1 - std::exp(-1e-3 / tau_s)}};
  Rig rig(spec);
  rig.enable_at(-0.006);
  double heat = rig.program.state().heat[0], highest = 0, effort = 0;
  bool limited = false;
  for (int i = 0; i < 5000; ++i) {
    const TickOutput out = rig.at(-0.006);
    effort = out.effort[0];
    for (int sub = 0; sub < 100; ++sub) heat += 1e-5 / tau_s * (effort * effort / 9 - heat);
    highest = std::max(highest, rig.program.state().heat[0]);
    ASSERT_NEAR(rig.program.state().heat[0], heat, 2e-3) << i;
    limited = limited || out.limits.has(Limit::temperature);
  }
  EXPECT_TRUE(limited);
  EXPECT_LE(highest, 1.0);
  EXPECT_GT(highest, 0.95);
  EXPECT_NEAR(effort, 3.0, 0.1) << "in the long run the continuous rating is what it gets";
}

TEST(Temperature, AColdMotorGetsAllItCanTake) {
  auto spec = wall_spec(1000);
  spec.thermals = {{.axis = 0, .continuous = 3, .share = 1e-4}};
  Rig rig(spec);
  EXPECT_NEAR(rig.enable_at(-0.009).effort[0], 9.0, 1e-12);
}

build::ProgramSpec travel_spec() {
  auto spec = spec_of(1);
  spec.travels = {
      {.axis = 0, .min = -0.05, .max = 0.05, .stiffness = 500, .max_effort = 2, .margin = 0.01}};
  return spec;
}

TEST(Travel, PushesBackFromBothEndsWithBoundedForce) {
  Rig rig(travel_spec());
  rig.enable_at(0.0);
  EXPECT_EQ(rig.at(0.0).effort[0], 0.0);
  const auto creep_to = [&](double position) {
    TickOutput output;
    const double from = rig.program.state().q[0];
    for (int i = 1; i <= 100; ++i) output = rig.at(from + (position - from) * i / 100);
    return output;
  };
  TickOutput out = creep_to(0.052);
  EXPECT_NEAR(out.effort[0], -1.0, 1e-6);
  EXPECT_TRUE(out.limits.has(Limit::travel));
  EXPECT_NEAR(creep_to(0.058).effort[0], -2.0, 1e-12) << "bounded";
  EXPECT_NEAR(creep_to(-0.051).effort[0], 0.5, 1e-6);
  EXPECT_EQ(creep_to(0.0).effort[0], 0.0);
}

TEST(Travel, BeyondTheMarginItTripsWithTheFigures) {
  Rig rig(travel_spec());
  rig.enable_at(0.0);
  for (int i = 1; i <= 61; ++i) rig.at(0.001 * i);
  const FaultReport& fault = rig.program.state().fault;
  EXPECT_EQ(fault.code, Fault::travel);
  EXPECT_NEAR(fault.found, 0.061, 1e-9);
  EXPECT_NEAR(fault.allowed, 0.06, 1e-9);
  EXPECT_EQ(rig.program.state().effort[0], 0.0);
}

TEST(Travel, TripsBeyondTheLowerEndToo) {
  Rig rig(travel_spec());
  rig.enable_at(0.0);
  for (int i = 1; i <= 60; ++i) rig.at(-0.001 * i + 1e-6);
  EXPECT_EQ(rig.program.state().mode, Mode::enabled);
  rig.at(-0.061);
  EXPECT_EQ(rig.program.state().fault.code, Fault::travel);
  EXPECT_NEAR(rig.program.state().fault.allowed, -0.06, 1e-9);
}

TEST(Workspace, LeavingTheBoxIsAFault) {
  auto spec = spec_of(2);
  spec.workspaces = {{.device = 0, .min = {-0.1, -0.2, 0}, .max = {0.1, 0.2, 0}}};
  Rig rig(spec);
  rig.enable_at(0.0);
  rig.samples[1].raw = Rig::raw(0.0);
  for (int i = 1; i <= 100; ++i) rig.at(0.001 * i);
  EXPECT_EQ(rig.program.state().mode, Mode::enabled);
  rig.at(0.1011);
  EXPECT_EQ(rig.program.state().fault.code, Fault::workspace);
  EXPECT_NEAR(rig.program.state().fault.allowed, 0.1, 1e-15);
}

build::ProgramSpec input_spec(bool estop) {
  auto spec = wall_spec(1000);
  spec.enable_inputs = {{.device = 0, .mask = 4, .active = 4, .estop = estop}};
  return spec;
}

TEST(EnableInput, DeadManTakesForcesOutByTheRampAndLetsThemInAgain) {
  Rig rig(input_spec(false));
  rig.at(-0.005);
  rig.input.enable = true;
  EXPECT_EQ(rig.at(-0.005).mode, Mode::idle) << "not held: no force";
  rig.aux[0].digital = 4 | 1;
  TickOutput out;
  for (int i = 0; i < 12; ++i) out = rig.at(-0.005);
  EXPECT_NEAR(out.effort[0], 5.0, 1e-12);
  rig.aux[0].digital = 1;
  EXPECT_NEAR(rig.at(-0.005).effort[0], 5.0 * 7 / 8, 1e-12);
  for (int i = 0; i < 10; ++i) out = rig.at(-0.005);
  EXPECT_EQ(out.effort[0], 0.0);
  EXPECT_EQ(out.mode, Mode::idle);
  EXPECT_EQ(out.fault.code, Fault::none);
  rig.aux[0].digital = 4;
  for (int i = 0; i < 12; ++i) out = rig.at(-0.005);
  EXPECT_NEAR(out.effort[0], 5.0, 1e-12);
}

TEST(EnableInput, EmergencyStopInputIsZeroInItsTickAndStays) {
  Rig rig(input_spec(true));
  rig.aux[0].digital = 4;
  rig.enable_at(-0.005);
  rig.aux[0].digital = 0;
  const TickOutput out = rig.at(-0.005);
  EXPECT_EQ(out.effort[0], 0.0);
  EXPECT_EQ(out.fault.code, Fault::estop);
  rig.aux[0].digital = 4;
  EXPECT_EQ(rig.at(-0.005).mode, Mode::fault);
}

TEST(EnableInput, EmergencyStopWhileIdleIsKept) {
  Rig rig(input_spec(true));
  rig.aux[0].digital = 0;
  EXPECT_EQ(rig.at(0.0).fault.code, Fault::estop);
}

}  // namespace
}  // namespace hapticd::control
