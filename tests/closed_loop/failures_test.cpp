// What the loop does when a device fails under it: zero force in the stated tick, by the stated
// name, and until cleared.
#include <gtest/gtest.h>

#include <cmath>
#include <ostream>

#include "tests/support/closed_loop.h"

namespace hapticd::test {
namespace {

constexpr std::int64_t kFailTick = 500;
constexpr std::int64_t kFailTicks = 300;
constexpr std::uint32_t kMaxStaleTicks = 3;
constexpr std::uint32_t kStuckTicks = 20;

// A hand that moves into a soft wall all the time, so that there is force and every reading differs
// from the last.
ClosedLoop pressed(sim::DeviceOptions device, LoopOptions options = {}) {
  device.hand = {.mass_kg = 0.2,
                 .stiffness_N_m = 300,
                 .damping_Ns_m = 2,
                 .script = {{.at_s = 2, .force_N = 0, .position_m = 0.04}}};
  options.stiffness_N_m = 200;
  options.damping_Ns_m = 0.1;
  options.max_velocity_m_s = 1.5;
  options.max_step_m = 0.015;  // ten times what that velocity covers in a tick
  options.max_stale_ticks = kMaxStaleTicks;
  return ClosedLoop(device, options);
}

struct Expected {
  sim::FailureKind kind;
  Fault fault;
  std::int64_t after_ticks;  ///< the force is zero this many ticks after the failure began
  const char* name;
};

void PrintTo(const Expected& expected, std::ostream* out) {
  *out << expected.name;
}

class EachFailure : public ::testing::TestWithParam<Expected> {
 protected:
  static ClosedLoop loop() {
    sim::DeviceOptions device = one_axis_device(0.1, 1);
    device.failures = {{.kind = GetParam().kind,
                        .axis = 0,
                        .at_s = 1e-3 * kFailTick,
                        .for_s = 1e-3 * kFailTicks,
                        .size_m = 0.02}};
    LoopOptions options;
    if (GetParam().kind == sim::FailureKind::stuck) options.stuck_ticks = kStuckTicks;
    return pressed(device, options);
  }
};

TEST_P(EachFailure, EndsInZeroForceInItsTick) {
  ClosedLoop loop = EachFailure::loop();
  const std::int64_t fault_tick = kFailTick + GetParam().after_ticks;
  while (loop.tick() < fault_tick - 1) {
    loop.run();
    ASSERT_EQ(loop.cycle().output().mode == control::Mode::fault, false) << "tick " << loop.tick();
  }
  EXPECT_GT(std::abs(loop.effort_N()), 0.1);
  loop.run();
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::fault);
  EXPECT_EQ(loop.cycle().output().fault.code, GetParam().fault)
      << "found " << entry(loop.cycle().output().fault.code).name;
  EXPECT_EQ(loop.effort_N(), 0);
  loop.run();
  EXPECT_EQ(loop.device().truth(0).effort_N, 0)
      << "the plant felt a force in the tick of the fault";
}

TEST_P(EachFailure, StaysUntilItIsCleared) {
  ClosedLoop loop = EachFailure::loop();
  while (loop.tick() < kFailTick + kFailTicks + 100) loop.run();
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::fault);
  EXPECT_EQ(loop.effort_N(), 0);
  loop.clear_fault = true;
  loop.run();
  loop.clear_fault = false;
  for (int i = 0; i < 200; ++i) loop.run();
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::enabled);
  EXPECT_GT(std::abs(loop.effort_N()), 0.01);
}

using sim::FailureKind;
INSTANTIATE_TEST_SUITE_P(
    Loop, EachFailure,
    ::testing::Values(Expected{FailureKind::nan, Fault::input_not_finite, 0, "nan"},
                      Expected{FailureKind::jump, Fault::encoder_jump, 0, "jump"},
                      Expected{FailureKind::missing, Fault::sample_missing, kMaxStaleTicks,
                               "missing"},
                      Expected{FailureKind::disarm, Fault::disarmed, 0, "disarm"},
                      Expected{FailureKind::fault, Fault::device, 0, "fault"},
                      Expected{FailureKind::stuck, Fault::encoder_stuck, kStuckTicks, "stuck"}),
    [](const auto& test) { return std::string(test.param.name); });

TEST(LoopFailure, SamplesMissingForTheLimitDoNoHarm) {
  sim::DeviceOptions device = one_axis_device(0.1, 1);
  device.failures = {{.kind = FailureKind::missing,
                      .axis = 0,
                      .at_s = 1e-3 * kFailTick,
                      .for_s = 1e-3 * kMaxStaleTicks,
                      .size_m = 0}};
  ClosedLoop loop = pressed(device);
  while (loop.tick() < kFailTick - 1) loop.run();
  const double before_N = std::abs(loop.effort_N());
  double least_N = before_N;
  while (loop.tick() < kFailTick + 200) {
    loop.run();
    ASSERT_NE(loop.cycle().output().mode, control::Mode::fault);
    ASSERT_LT(std::abs(loop.effort_N()), 1.5 * before_N) << "tick " << loop.tick();
    least_N = std::min(least_N, std::abs(loop.effort_N()));
  }
  EXPECT_LT(least_N, 0.5 * before_N) << "forces fade while nothing is known";
  EXPECT_GT(std::abs(loop.effort_N()), 0.5 * before_N) << "and come back";
}

sim::DeviceOptions jumping(double size_m) {
  sim::DeviceOptions device = one_axis_device(0.1, 1);
  device.failures = {{.kind = FailureKind::jump,
                      .axis = 0,
                      .at_s = 1e-3 * kFailTick,
                      .for_s = 0.01,
                      .size_m = size_m}};
  return device;
}

TEST(LoopFailure, AJumpWithinTheVelocityLimitIsFelt) {
  ClosedLoop loop = pressed(jumping(0.001));
  while (loop.tick() < kFailTick - 1) loop.run();
  const double before_N = loop.effort_N();
  loop.run();
  EXPECT_EQ(loop.cycle().output().mode, control::Mode::enabled);
  // 1 mm of a wall of 200 N/m, and its damper of 0.1 N s/m at 1 m/s
  EXPECT_NEAR(loop.effort_N() - before_N, -0.3, 0.02);
}

TEST(LoopFailure, AJumpThatCouldBeMotionIsAVelocityFault) {
  ClosedLoop loop = pressed(jumping(0.01));
  while (loop.tick() < kFailTick) loop.run();
  EXPECT_EQ(loop.cycle().output().fault.code, Fault::velocity);
  EXPECT_EQ(loop.effort_N(), 0);
}

TEST(LoopFailure, VelocityTripEndsInZeroForce) {
  sim::DeviceOptions device = one_axis_device(0.1, 1);
  device.hand.script = {{.at_s = 0, .force_N = 1, .position_m = 0},
                        {.at_s = 0.5, .force_N = 40, .position_m = 0}};
  ClosedLoop loop(device, {.stiffness_N_m = 200, .damping_Ns_m = 0.5, .max_velocity_m_s = 0.5});
  double last_m = 0;
  double speed_m_s = 0;
  while (loop.tick() < 1000 && loop.cycle().output().mode != control::Mode::fault) {
    const double before_N = loop.tick() < 0 ? 0 : loop.effort_N();
    loop.run();
    const double x_m = loop.device().truth(0).position_m;
    speed_m_s = std::abs(x_m - last_m) * 1000;
    last_m = x_m;
    if (speed_m_s > 0.5) {
      EXPECT_GT(std::abs(before_N), 0.5);
      break;
    }
    ASSERT_NE(loop.cycle().output().mode, control::Mode::fault) << speed_m_s;
  }
  EXPECT_GT(loop.tick(), 500);
  const FaultReport fault = loop.cycle().output().fault;
  EXPECT_EQ(fault.code, Fault::velocity);
  EXPECT_NEAR(fault.found, speed_m_s, 1e-5);
  EXPECT_EQ(fault.allowed, 0.5);
  EXPECT_EQ(loop.effort_N(), 0);
  for (int i = 0; i < 100; ++i) {
    loop.run();
    ASSERT_EQ(loop.effort_N(), 0);
    ASSERT_EQ(loop.device().truth(0).effort_N, 0);
  }
}

// Through 65535 -> 0 twice and more: the same forces as with a counter that never wraps.
TEST(LoopFailure, AWrappingCounterIsNoFaultAndNoStep) {
  sim::DeviceOptions wide = one_axis_device(0.1, 1);
  wide.axes[0].counts_per_m = 1e6;
  wide.axes[0].encoder_bits = 0;
  wide.axes[0].position_m = 0.06553;  // count 65530
  wide.hand.script = {{.at_s = 0, .force_N = 5, .position_m = 0},
                      {.at_s = 1, .force_N = -5, .position_m = 0}};
  sim::DeviceOptions narrow = wide;
  narrow.axes[0].encoder_bits = 16;
  // The first reading is taken as signed, so the 16-bit axis calls the start -6 um.
  const double shift_m = 0.065536;
  LoopOptions options{.stiffness_N_m = 40, .damping_Ns_m = 0.5, .surface_m = 0.06};
  options.max_step_m = 0.015;
  ClosedLoop wide_loop(wide, options);
  options.surface_m -= shift_m;
  ClosedLoop narrow_loop(narrow, options);
  int wraps = 0;
  double last_raw = 65530;
  for (int i = 0; i < 2000; ++i) {
    wide_loop.run();
    narrow_loop.run();
    const double raw = narrow_loop.cycle().samples()[0].raw;
    wraps += std::abs(raw - last_raw) > 32768;
    last_raw = raw;
    ASSERT_NE(narrow_loop.cycle().output().mode, control::Mode::fault);
    ASSERT_NEAR(narrow_loop.effort_N(), wide_loop.effort_N(), 1e-9) << "tick " << i;
  }
  EXPECT_GE(wraps, 4);
}

}  // namespace
}  // namespace hapticd::test
