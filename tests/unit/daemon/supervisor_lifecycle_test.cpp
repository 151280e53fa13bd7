#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "daemon/lifecycle.h"

namespace hapticd::daemon {
namespace {

using control::Mode;
using testing::HasSubstr;
using testing::Not;

constexpr Seen kRunning{.starting = true, .looping = true, .mode = Mode::idle};

Seen running(Mode mode) {
  Seen seen = kRunning;
  seen.mode = mode;
  return seen;
}

TEST(Lifecycle, ConnectsUntilTheLoopRuns) {
  EXPECT_EQ(next_state(State::off, {}), State::off);
  EXPECT_EQ(next_state(State::off, {.starting = true}), State::connecting);
  EXPECT_EQ(next_state(State::connecting, {.starting = true}), State::connecting);
  EXPECT_EQ(next_state(State::connecting, {}), State::off);
  EXPECT_EQ(next_state(State::connecting, kRunning), State::ready);
}

TEST(Lifecycle, ARunningLoopSaysWhereItIs) {
  for (const State now : {State::ready, State::homing, State::enabled, State::fault}) {
    EXPECT_EQ(next_state(now, running(Mode::idle)), State::ready);
    EXPECT_EQ(next_state(now, running(Mode::homing)), State::homing);
    EXPECT_EQ(next_state(now, running(Mode::enabled)), State::enabled);
    EXPECT_EQ(next_state(now, running(Mode::fault)), State::fault);
  }
}

TEST(Lifecycle, AnEndedLoopIsOffFromAnywhere) {
  for (const State now : {State::ready, State::homing, State::enabled, State::fault}) {
    EXPECT_EQ(next_state(now, {}), State::off);
    EXPECT_EQ(next_state(now, {.starting = true}), State::off);
  }
}

build::ProgramSpec names() {
  build::ProgramSpec spec;
  spec.device_names = {"left"};
  spec.axis_names = {"left.x"};
  return spec;
}

TEST(DescribeFault, NamesTheAxisTheFiguresAndWhatToDo) {
  const FaultReport fault{
      .code = Fault::velocity, .axis = 0, .device = 0, .found = 2.5, .allowed = 1.5};
  const std::string text = describe_fault(fault, names());
  EXPECT_THAT(text, HasSubstr("faster than guard.max_velocity"));
  EXPECT_THAT(text, HasSubstr("left.x: found 2.5 m/s, allowed 1.5 m/s"));
  EXPECT_THAT(text, HasSubstr("hapticctl enable"));
}

TEST(DescribeFault, ARotaryAxisHasItsOwnUnits) {
  build::ProgramSpec spec = names();
  spec.rotary = {true};
  for (const auto& [code, unit] :
       {std::pair{Fault::velocity, "2.5 rad/s"}, std::pair{Fault::encoder_jump, "2.5 rad,"},
        std::pair{Fault::travel, "2.5 rad,"}}) {
    const FaultReport fault{.code = code, .axis = 0, .found = 2.5, .allowed = 1.5};
    EXPECT_THAT(describe_fault(fault, spec), HasSubstr(unit));
  }
}

TEST(DescribeFault, SaysNothingOfFiguresThatAFaultDoesNotHave) {
  const std::string text = describe_fault({.code = Fault::estop}, names());
  EXPECT_THAT(text, Not(HasSubstr("found")));
  EXPECT_THAT(text, HasSubstr("set by: operator"));
}

TEST(DescribeFault, PassesOnWhatTheDriverSays) {
  const FaultReport fault{.code = Fault::device, .device = 0};
  EXPECT_THAT(describe_fault(fault, names(), "motor too hot"),
              HasSubstr("left; the driver says: motor too hot"));
}

TEST(DescribeFault, AnIndexOutOfRangeBlamesNobody) {
  EXPECT_EQ(blamed({.code = Fault::velocity, .axis = 7, .device = 9}, names()), "");
}

TEST(DescribeFault, EveryFaultHasWords) {
  for (const FaultEntry& row : fault_table()) {
    EXPECT_THAT(describe_fault({.code = row.code}, names()), HasSubstr(std::string(row.meaning)));
  }
}

}  // namespace
}  // namespace hapticd::daemon
