// Homing against a simulated axis of the simplest kind: it moves as it is pushed, between two
// stops.
#include "control/motion/homing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using test::Rig;

constexpr double kPeriod = 1e-3;

/// A mass with friction between stops at -20 mm and +30 mm; the encoder counts from 0 where it was
/// switched on.
struct Slider {
  double mass = 0.05, damping = 2, dry = 0.05;
  double x = 5e-3, v = 0, start = 5e-3;
  double max_speed = 0;
  bool jammed = false;

  void push(double force) {
    for (int i = 0; i < 10; ++i) {
      const double friction = damping * v + (v > 0 ? dry : v < 0 ? -dry : 0);
      double next = v + 1e-4 * (force - friction) / mass;
      if ((v == 0 && std::abs(force) <= dry) || v * next < 0 || jammed) next = 0;
      v = next;
      x += 1e-4 * v;
      if (x < -20e-3 || x > 30e-3) v = 0;
      x = std::clamp(x, -20e-3, 30e-3);
      max_speed = std::max(max_speed, std::abs(v));
    }
  }
  double encoder() const { return x - start; }
};

HomingPlan plan(HomingBy by, double effort) {
  return {.axis = 0,
          .by = by,
          .position = 0.1,
          .effort = effort,
          .effort_per_tick = std::abs(effort) / 500,
          .velocity = 0.02,
          .still_ticks = 100,
          .max_ticks = 8000};
}

build::ProgramSpec spec(const HomingPlan& homing) {
  auto spec = test::spec_of(1);
  spec.planes = {test::wall(1000, 0)};
  spec.planes[0].offset = -1;  // far away
  spec.homings = {homing};
  return spec;
}

struct Bench {
  explicit Bench(const HomingPlan& homing) : rig(spec(homing)) { rig.input.enable = true; }
  TickOutput tick() {
    const TickOutput output = rig.at(slider.encoder());
    slider.push(output.effort[0]);
    max_effort = std::max(max_effort, std::abs(output.effort[0]));
    return output;
  }
  /// Runs until the mode is not `mode`; ticks that it took.
  int until_not(Mode mode, int most) {
    int ticks = 0;
    while (tick().mode == mode && ticks < most) ++ticks;
    return ticks;
  }
  double q() const { return rig.program.state().q[0]; }
  Mode mode() const { return rig.program.state().mode; }
  Fault fault() const { return rig.program.state().fault.code; }

  Rig rig;
  Slider slider;
  double max_effort = 0;
};

TEST(Homing, FindsTheHardStopWithBoundedForceAndSpeedThenEnables) {
  Bench bench(plan(HomingBy::hard_stop, -1));
  EXPECT_EQ(bench.tick().mode, Mode::homing);
  bench.until_not(Mode::homing, 8000);
  EXPECT_EQ(bench.mode(), Mode::enabled);
  EXPECT_NEAR(bench.slider.x, -20e-3, 1e-12);
  EXPECT_NEAR(bench.q(), 0.1, 1e-6) << "the stop is where homing.position says";
  EXPECT_LE(bench.max_effort, 1.0);
  EXPECT_LE(bench.slider.max_speed, 0.04);
  EXPECT_GT(bench.slider.max_speed, 0.005) << "or it was already there and nothing was shown";
  EXPECT_EQ(bench.rig.program.state().effort[0], 0.0) << "starts from nothing";
  EXPECT_TRUE(bench.rig.program.state().axes[0].homed);
}

TEST(Homing, PositiveEffortFindsTheOtherStop) {
  Bench bench(plan(HomingBy::hard_stop, 1));
  bench.tick();
  bench.until_not(Mode::homing, 8000);
  EXPECT_EQ(bench.mode(), Mode::enabled);
  EXPECT_NEAR(bench.slider.x, 30e-3, 1e-12);
  EXPECT_NEAR(bench.q(), 0.1, 1e-6);
}

TEST(Homing, MovingOnAfterwardsCountsFromTheReference) {
  Bench bench(plan(HomingBy::hard_stop, -1));
  bench.tick();
  bench.until_not(Mode::homing, 8000);
  bench.slider.x += 7e-3;
  bench.tick();
  EXPECT_NEAR(bench.q(), 0.107, 1.1e-6);
}

TEST(Homing, TheShiftOfTheScaleIsNeitherWorkNorSpeed) {
  Bench bench(plan(HomingBy::hard_stop, -1));
  bench.tick();
  double work = 0;
  while (bench.mode() == Mode::homing) {
    work = bench.rig.program.state().work[0];
    bench.tick();
  }
  EXPECT_NEAR(bench.rig.program.state().work[0], work, 1e-9);
  EXPECT_EQ(bench.rig.program.state().qd[0], 0.0);
}

TEST(Homing, AnIndexThatComesByIsTakenAtItsOwnCount) {
  Bench bench(plan(HomingBy::index, 0));
  EXPECT_EQ(bench.tick().mode, Mode::idle) << "nobody drives: a hand has to";
  for (int i = 0; i < 7; ++i) {
    bench.slider.x += 1e-3;  // by hand
    bench.tick();
  }
  bench.rig.samples[0].index = true;
  bench.rig.samples[0].index_raw = Rig::raw(3e-3);
  EXPECT_EQ(bench.tick().mode, Mode::enabled);
  EXPECT_NEAR(bench.q(), 0.1 + (7e-3 - 3e-3), 1e-9);
}

TEST(Homing, AnIndexBelowZeroOfAWrappingCounterIsTheNearOne) {
  Bench bench(plan(HomingBy::index, 0));
  bench.tick();
  bench.rig.samples[0].index = true;
  bench.rig.samples[0].index_raw = Rig::raw(-2e-3);
  bench.tick();
  EXPECT_NEAR(bench.q(), 0.1 + 2e-3, 1e-9);
}

TEST(Homing, ASearchForTheIndexTurnsRoundAtTheStopOnce) {
  Bench bench(plan(HomingBy::index, -1));
  bench.tick();
  bool turned = false;
  for (int i = 0; i < 8000 && bench.mode() == Mode::homing; ++i) {
    bench.tick();
    turned = turned || bench.slider.x <= -20e-3;
    if (turned && bench.slider.x > 0) {
      bench.rig.samples[0].index = true;
      bench.rig.samples[0].index_raw = Rig::raw(0.0 - bench.slider.start);
    }
  }
  EXPECT_TRUE(turned);
  EXPECT_EQ(bench.mode(), Mode::enabled);
  EXPECT_NEAR(bench.q(), 0.1 + bench.slider.x, 2e-4);
}

TEST(Homing, NoIndexBetweenTheStopsIsAFault) {
  Bench bench(plan(HomingBy::index, -1));
  bench.rig.input.enable = true;
  bench.tick();
  bench.until_not(Mode::homing, 8000);
  EXPECT_EQ(bench.mode(), Mode::fault);
  EXPECT_EQ(bench.fault(), Fault::homing);
  EXPECT_EQ(bench.rig.program.state().effort[0], 0.0);
}

TEST(Homing, TakingTooLongIsAFaultWithItsTime) {
  auto homing = plan(HomingBy::hard_stop, -1);
  homing.max_ticks = 300;
  Bench bench(homing);
  bench.tick();
  bench.until_not(Mode::homing, 1000);
  EXPECT_EQ(bench.fault(), Fault::homing);
  EXPECT_NEAR(bench.rig.program.state().fault.allowed, 300 * kPeriod, 1e-12);
  EXPECT_EQ(bench.tick().effort[0], 0.0);
}

TEST(Homing, AFaultClearedSearchesAnew) {
  auto homing = plan(HomingBy::hard_stop, -1);
  homing.max_ticks = 3000;
  Bench bench(homing);
  bench.rig.input.host_fault.code = Fault::none;
  bench.tick();
  for (int i = 0; i < 200; ++i) bench.tick();
  bench.rig.input.host_fault.code = Fault::estop;
  EXPECT_EQ(bench.tick().effort[0], 0.0) << "an e-stop ends a search in its tick";
  bench.rig.input.host_fault.code = Fault::none;
  bench.rig.input.clear_fault = true;
  bench.tick();
  bench.until_not(Mode::homing, 3000);
  EXPECT_EQ(bench.mode(), Mode::enabled);
}

TEST(Homing, LettingGoOfEnableEndsTheSearchAtOnce) {
  Bench bench(plan(HomingBy::hard_stop, -1));
  for (int i = 0; i < 200; ++i) bench.tick();
  ASSERT_NE(bench.rig.program.state().effort[0], 0.0);
  bench.rig.input.enable = false;
  const TickOutput output = bench.tick();
  EXPECT_EQ(output.mode, Mode::idle);
  EXPECT_EQ(output.effort[0], 0.0);
}

TEST(Homing, TheDevicesWordMakesItsCountsAbsolute) {
  Bench bench(plan(HomingBy::device, 0));
  bench.tick();
  EXPECT_EQ(bench.tick().mode, Mode::idle);
  bench.slider.start = 0;  // the device found its zero: counts jump
  bench.rig.samples[0].homed = true;
  bench.tick();
  EXPECT_NEAR(bench.q(), 5e-3, 1e-6);
  EXPECT_EQ(bench.tick().mode, Mode::enabled);
  EXPECT_NEAR(bench.q(), 5e-3, 1e-6);
}

/// Without friction nothing but the search itself holds the axis back.
TEST(Homing, ALightAxisWithoutFrictionIsNotThrownAtTheStop) {
  for (const double mass : {0.01, 0.05, 0.3}) {
    Bench bench(plan(HomingBy::hard_stop, -1));
    bench.slider.mass = mass;
    bench.slider.damping = bench.slider.dry = 0;
    bench.tick();
    bench.until_not(Mode::homing, 8000);
    EXPECT_EQ(bench.mode(), Mode::enabled) << mass;
    EXPECT_LE(bench.slider.max_speed, 0.045) << mass;
  }
}

TEST(Homing, AReferenceThatIsLostWhileEnabledIsAFault) {
  Bench bench(plan(HomingBy::device, 0));
  bench.rig.samples[0].homed = true;
  bench.tick();
  ASSERT_EQ(bench.tick().mode, Mode::enabled);
  bench.rig.samples[0].homed = false;
  bench.tick();
  EXPECT_EQ(bench.fault(), Fault::homing);
}

TEST(Homing, AxesAreSearchedOneAfterTheOther) {
  auto homing = plan(HomingBy::hard_stop, -1);
  auto two = spec(homing);
  two = test::spec_of(2);
  two.homings = {homing, homing};
  two.homings[1].axis = 1;
  Rig rig(two);
  Slider a, b;
  rig.input.enable = true;
  bool both = false, second = false;
  for (int i = 0; i < 16000; ++i) {
    rig.samples[0].raw = Rig::raw(a.encoder());
    rig.samples[1].raw = Rig::raw(b.encoder());
    const TickOutput output = rig.again();
    a.push(output.effort[0]);
    b.push(output.effort[1]);
    both = both || (output.effort[0] != 0 && output.effort[1] != 0);
    second = second || output.effort[1] != 0;
    if (output.mode == Mode::enabled) break;
  }
  EXPECT_TRUE(second);
  EXPECT_FALSE(both);
  EXPECT_EQ(rig.program.state().mode, Mode::enabled);
  EXPECT_NEAR(rig.program.state().q[0], 0.1, 1e-6);
  EXPECT_NEAR(rig.program.state().q[1], 0.1, 1e-6);
}

TEST(Homing, WhatWasFoundIsForgottenWhenTheDeviceComesBack) {
  Bench bench(plan(HomingBy::hard_stop, -1));
  bench.tick();
  bench.until_not(Mode::homing, 8000);
  ASSERT_EQ(bench.mode(), Mode::enabled);
  bench.rig.input.host_fault = {.code = Fault::device, .device = 0};
  bench.tick();
  bench.rig.input.host_fault = {};
  bench.rig.input.enable = false;
  bench.rig.input.clear_fault = true;
  bench.tick();
  bench.rig.input.clear_fault = false;
  ASSERT_EQ(bench.mode(), Mode::idle);
  ASSERT_TRUE(bench.rig.program.state().axes[0].homed);

  bench.slider.start = bench.slider.x + 0.004;  // it counts from where it was switched on
  bench.rig.samples[0].raw = bench.slider.encoder() / 1e-6;
  bench.rig.samples[0].freshness = Freshness::first;
  bench.rig.run();
  EXPECT_FALSE(bench.rig.program.state().axes[0].homed);
  bench.rig.samples[0].freshness = Freshness::fresh;
  bench.rig.input.enable = true;
  EXPECT_EQ(bench.tick().mode, Mode::homing);
  bench.until_not(Mode::homing, 8000);
  ASSERT_EQ(bench.mode(), Mode::enabled);
  EXPECT_NEAR(bench.q(), 0.1, 1e-6) << "the stop is where homing.position says, again";
}

}  // namespace
}  // namespace hapticd::control
