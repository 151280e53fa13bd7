// The real thread on the real clock: limits are set so high that a busy machine cannot fail a test.
#include "daemon/servo_thread.h"

#include <gtest/gtest.h>

#include <chrono>
#include <functional>

#include "tests/support/fake_device.h"
#include "tests/support/program_fixture.h"

namespace hapticd::daemon {
namespace {

using control::Mode;

bool eventually(const std::function<bool()>& condition) {
  const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > give_up) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

build::ProgramSpec wall_spec(double stiffness) {
  auto spec = test::spec_of(1);
  spec.planes = {test::wall(stiffness, 0)};
  return spec;
}

class Servo : public testing::Test {
 protected:
  Servo()
      : program(wall_spec(1000)),
        storage(slot_bytes() * 64),
        shared(storage, slot_bytes()),
        thread({.schedule = {.max_gap_ticks = 1'000'000, .max_missed_per_s = 1'000'000}}, {&device},
               &program, shared) {
    device.raw[0] = test::Rig::raw(-0.002);
    thread.start(report);
  }
  /// Room for another plan's records too.
  std::size_t slot_bytes() const { return program.plan().record.bytes + 64; }
  bool reaches(Mode mode) {
    return eventually([&] {
      ServoStatus status;
      return shared.status.load(status) && status.mode == mode &&
             (mode != Mode::enabled || status.ramp == 1);
    });
  }
  /// A tick that has surely begun and ended after now.
  bool next_ticks() {
    const std::uint64_t from = shared.counters.ticks.load();
    return eventually([&] { return shared.counters.ticks.load() >= from + 2; });
  }

  test::FakeDevice device{1};
  build::Program program;
  std::vector<std::byte> storage;
  ServoShared shared;
  RealtimeReport report;
  ServoThread thread;
};

TEST_F(Servo, RunsIdleWithoutForceUntilEnabled) {
  EXPECT_TRUE(reaches(Mode::idle));
  ASSERT_TRUE(next_ticks());
  thread.stop();
  EXPECT_EQ(device.effort[0], 0.0);
  EXPECT_FALSE(report.scheduling.empty());
}

TEST_F(Servo, EndsByRampAndStopCycles) {
  shared.enable = true;
  ASSERT_TRUE(reaches(Mode::enabled));
  thread.stop();
  EXPECT_TRUE(shared.ended);
  EXPECT_GE(device.stops, 5);
  EXPECT_EQ(device.effort[0], 0.0);
  EXPECT_FALSE(device.armed);
  EXPECT_NEAR(shared.counters.largest_force_N.load(), 2.0, 1e-9);
}

TEST_F(Servo, EmergencyStopHoldsUntilCleared) {
  shared.enable = true;
  ASSERT_TRUE(reaches(Mode::enabled));
  shared.estop = true;
  ASSERT_TRUE(reaches(Mode::fault));
  EXPECT_FALSE(shared.enable.load()) << "nothing comes back by itself";
  shared.estop = false;
  ASSERT_TRUE(next_ticks());
  EXPECT_TRUE(reaches(Mode::fault));
  shared.enable = true;
  ++shared.clears;
  EXPECT_TRUE(reaches(Mode::enabled));
}

TEST_F(Servo, FaultRaisedFromASignalHandlerIsTaken) {
  shared.enable = true;
  ASSERT_TRUE(reaches(Mode::enabled));
  shared.host_fault = static_cast<std::uint8_t>(Fault::cpu_time);
  ASSERT_TRUE(reaches(Mode::fault));
  ServoStatus status;
  ASSERT_TRUE(eventually([&] { return shared.status.load(status); }));
  EXPECT_EQ(status.fault.code, Fault::cpu_time);
}

TEST_F(Servo, PlanIsSwappedUnderARunningLoop) {
  shared.enable = true;
  ASSERT_TRUE(reaches(Mode::enabled));
  build::Program harder(wall_spec(2000));
  ASSERT_TRUE(shared.plans.offer(&harder));
  build::Program* old = nullptr;
  ASSERT_TRUE(eventually([&] { return (old = shared.plans.collect()) != nullptr; }));
  EXPECT_EQ(old, &program);
  ASSERT_TRUE(next_ticks());
  thread.stop();
  EXPECT_EQ(thread.program(), &harder);
  EXPECT_NEAR(shared.counters.largest_force_N.load(), 4.0, 1e-9);
}

TEST_F(Servo, RecordsOfAnotherLayoutWaitUntilTheyAreAskedFor) {
  auto spec = wall_spec(1000);
  spec.frictions = {{.axis = 0}};  // one more array in each record
  build::Program other(std::move(spec));
  ASSERT_GT(other.plan().record.bytes, program.plan().record.bytes);
  ASSERT_TRUE(shared.plans.offer(&other));
  ASSERT_TRUE(eventually([&] { return shared.plans.collect() != nullptr; }));
  EXPECT_TRUE(shared.records_held);
  while (shared.records.front() != nullptr) shared.records.pop();
  ASSERT_TRUE(next_ticks());
  EXPECT_EQ(shared.records.front(), nullptr);
  shared.records_held = false;
  EXPECT_TRUE(eventually([&] { return shared.records.front() != nullptr; }));
  thread.stop();
}

TEST_F(Servo, FullRecordRingDoesNotStopTheLoop) {
  ASSERT_TRUE(eventually([&] { return shared.records.dropped() > 0; })) << "64 slots and no reader";
  EXPECT_TRUE(next_ticks());
}

}  // namespace
}  // namespace hapticd::daemon
