#include "daemon/cycle.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <utility>

#include "tests/support/fake_device.h"
#include "tests/support/program_fixture.h"

namespace hapticd::daemon {
namespace {

using control::Mode;

std::int64_t no_clock() noexcept {
  return 0;
}

struct Loop {
  explicit Loop(double stiffness = 1000) : Loop(spec(stiffness)) {}
  explicit Loop(build::ProgramSpec given)
      : program(std::move(given)), cycle({&device}, program.plan()) {}

  static build::ProgramSpec spec(double stiffness) {
    auto spec = test::spec_of(1);
    spec.planes = {test::wall(stiffness, 0)};
    return spec;
  }
  const control::TickOutput& tick() {
    cycle.run(program, input, no_clock, nullptr);
    ++input.time.tick;
    input.clear_fault = false;
    return cycle.output();
  }
  void enable() {
    device.raw[0] = test::Rig::raw(-0.002);
    input.enable = true;
    for (int i = 0; i < 12; ++i) tick();
  }

  test::FakeDevice device{1};
  build::Program program;
  Cycle cycle;
  CycleInput input;
};

TEST(Cycle, ForceReachesTheDeviceInTheTickThatMeasured) {
  Loop loop;
  loop.enable();
  EXPECT_NEAR(loop.device.effort[0], 2.0, 1e-12);
  loop.device.raw[0] = test::Rig::raw(-0.003);
  loop.tick();
  EXPECT_NEAR(loop.device.effort[0], 3.0, 1e-12);
}

TEST(Cycle, NoForceUntilThePowerStageIsOn) {
  Loop loop;
  loop.device.refuses_to_arm = true;
  loop.enable();
  EXPECT_EQ(loop.cycle.output().mode, Mode::idle);
  EXPECT_EQ(loop.device.effort[0], 0.0);
  EXPECT_FALSE(loop.cycle.armed());
}

TEST(Cycle, DisablingFadesAndThenTakesThePowerStageOff) {
  Loop loop;
  loop.enable();
  loop.input.enable = false;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(loop.tick().mode, Mode::enabled);
  EXPECT_TRUE(loop.device.armed);
  for (int i = 0; i < 6; ++i) loop.tick();
  EXPECT_EQ(loop.cycle.output().mode, Mode::idle);
  EXPECT_FALSE(loop.device.armed);
}

TEST(Cycle, DeviceThatDropsOutIsAFaultNamedByDevice) {
  Loop loop;
  loop.enable();
  loop.device.armed = false;
  EXPECT_EQ(loop.tick().fault.code, Fault::disarmed);
  EXPECT_EQ(loop.cycle.output().fault.device, 0);
  EXPECT_EQ(loop.device.effort[0], 0.0);
}

/// An axis that is driven to its stop before forces may be on, and stands there for a second until
/// that is believed.
struct HomingLoop : Loop {
  HomingLoop() : Loop(searching()) {}
  static build::ProgramSpec searching() {
    auto spec = Loop::spec(1000);
    spec.homings = {{.axis = 0,
                     .by = control::HomingBy::hard_stop,
                     .position = -1,
                     .effort = -1,
                     .effort_per_tick = 0.01,
                     .velocity = 0.05,
                     .still_ticks = 1000,
                     .max_ticks = 5000}};
    return spec;
  }
};

TEST(Cycle, DevicesStayArmedWhileAnAxisIsHomed) {
  HomingLoop loop;
  loop.enable();
  EXPECT_EQ(loop.cycle.output().mode, Mode::homing);
  EXPECT_TRUE(loop.device.armed);
  EXPECT_LT(loop.device.effort[0], 0);
  loop.input.enable = false;
  loop.tick();
  EXPECT_EQ(loop.cycle.output().mode, Mode::idle);
  EXPECT_EQ(loop.device.effort[0], 0.0);
  EXPECT_FALSE(loop.device.armed);
}

TEST(Cycle, DeviceThatDropsOutWhileItIsHomedIsAFault) {
  HomingLoop loop;
  loop.enable();
  ASSERT_EQ(loop.cycle.output().mode, Mode::homing);
  loop.device.armed = false;
  EXPECT_EQ(loop.tick().fault.code, Fault::disarmed);
  EXPECT_EQ(loop.device.effort[0], 0.0);
}

TEST(Cycle, DeviceThatGivesUpIsAFaultEvenWhileIdle) {
  Loop loop;
  loop.tick();
  loop.device.faulted = true;
  EXPECT_EQ(loop.tick().fault.code, Fault::device);
  EXPECT_EQ(loop.device.stops, 1);
}

TEST(Cycle, FaultStopsTheDeviceEveryTick) {
  Loop loop;
  loop.enable();
  loop.input.host_fault = {.code = Fault::estop};
  for (int i = 0; i < 3; ++i) loop.tick();
  EXPECT_EQ(loop.device.stops, 3);
  EXPECT_FALSE(loop.device.armed);
  EXPECT_EQ(loop.device.effort[0], 0.0);
}

TEST(Cycle, FaultIsLeftByAnOperatorAndTheForceFadesInAnew) {
  Loop loop;
  loop.enable();
  loop.input.host_fault = {.code = Fault::overrun};
  loop.tick();
  loop.input.host_fault = {.code = Fault::none};
  for (int i = 0; i < 20; ++i) EXPECT_EQ(loop.tick().mode, Mode::fault);
  loop.input.clear_fault = true;
  double last = 0;
  for (int i = 0; i < 14; ++i) {
    loop.tick();
    EXPECT_LE(loop.device.effort[0] - last, 0.25 + 1e-12);
    last = loop.device.effort[0];
  }
  EXPECT_NEAR(last, 2.0, 1e-12);
}

TEST(Cycle, SilentDeviceIsGivenUpAtTheDeadline) {
  Loop loop;
  loop.enable();
  loop.device.silent = true;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(loop.tick().mode, Mode::enabled);
  EXPECT_EQ(loop.tick().fault.code, Fault::sample_missing);
}

TEST(Cycle, WaitsForTheBusAndNoLongerThanTheDeadline) {
  int pipe_fds[2];
  ASSERT_EQ(pipe(pipe_fds), 0);
  Loop loop;
  loop.device.silent = true;
  loop.device.fd = pipe_fds[0];
  loop.input.time.deadline_ns = 2'000'000;  // the clock stands at 0: a wait of 2 ms
  loop.tick();
  EXPECT_EQ(loop.cycle.samples()[0].freshness, Freshness::missing);
  close(pipe_fds[0]);
  close(pipe_fds[1]);
}

TEST(Cycle, RecordGapShowsWhatTheRingDropped) {
  Loop loop;
  const std::size_t bytes = loop.program.plan().record.bytes;
  std::vector<std::byte> storage(2 * bytes);
  rt::SpscRing ring(storage, bytes);
  const auto sequence = [&] {
    control::RecordHeader header;
    std::memcpy(&header, ring.front(), sizeof header);
    ring.pop();
    return header.sequence;
  };
  for (int i = 0; i < 4; ++i) loop.cycle.run(loop.program, loop.input, no_clock, &ring);
  EXPECT_EQ(ring.dropped(), 2u);
  EXPECT_EQ(sequence(), 0u);
  EXPECT_EQ(sequence(), 1u);
  loop.cycle.run(loop.program, loop.input, no_clock, &ring);
  EXPECT_EQ(sequence(), 4u);
}

}  // namespace
}  // namespace hapticd::daemon
