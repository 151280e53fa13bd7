// The overrun policy in virtual time: lateness is scripted, nothing sleeps.
#include "daemon/tick_schedule.h"

#include <gtest/gtest.h>

namespace hapticd::daemon {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kSecond = 1000 * kMs;

struct Script {
  explicit Script(TickScheduleOptions options = {}) : schedule(options) {
    schedule.start({now, now + boot});
  }

  /// Wakes `late_ns` after the planned time.
  Wake wake(std::int64_t late_ns = 0) {
    now = schedule.next_ns() + late_ns;
    return schedule.woke({now, now + boot});
  }

  std::int64_t now = 10 * kSecond;
  std::int64_t boot = 3 * kSecond;  // slept once before we started
  TickSchedule schedule;
};

TEST(TickSchedule, TicksFollowOneAnotherAPeriodApart) {
  Script script;
  for (int i = 0; i < 5; ++i) {
    const Wake wake = script.wake(50'000);
    EXPECT_EQ(wake.tick, i);
    EXPECT_EQ(wake.start_ns, 10 * kSecond + (i + 1) * kMs);
    EXPECT_EQ(wake.late_ns, 50'000);
    EXPECT_EQ(wake.missed_ticks, 0);
    EXPECT_EQ(wake.fault.code, Fault::none);
  }
}

TEST(TickSchedule, LateWakeWithinThePeriodMissesNothing) {
  Script script;
  const Wake wake = script.wake(kMs - 1);
  EXPECT_EQ(wake.missed_ticks, 0);
  EXPECT_EQ(wake.late_ns, kMs - 1);
}

TEST(TickSchedule, LateWakeJumpsToTheCurrentPeriodWithoutABurst) {
  Script script;
  script.wake();
  const Wake late = script.wake(3 * kMs + 200'000);
  EXPECT_EQ(late.tick, 1 + 3);
  EXPECT_EQ(late.missed_ticks, 3);
  EXPECT_EQ(late.late_ns, 200'000);
  EXPECT_EQ(late.fault.code, Fault::none);
  const Wake next = script.wake();
  EXPECT_EQ(next.tick, 5);
  EXPECT_EQ(next.start_ns, late.start_ns + kMs) << "the grid of periods stays where it is";
  EXPECT_EQ(next.missed_ticks, 0);
}

TEST(TickSchedule, GapUpToTheLimitIsRiddenOutAndOneMoreIsAFault) {
  Script script({.max_gap_ticks = 5});
  EXPECT_EQ(script.wake(5 * kMs).fault.code, Fault::none);
  const Wake wake = script.wake(6 * kMs);
  EXPECT_EQ(wake.fault.code, Fault::overrun);
  EXPECT_EQ(wake.fault.found, 6);
  EXPECT_EQ(wake.fault.allowed, 5);
}

TEST(TickSchedule, ZeroGapLimitMakesAnyMissedTickAFault) {
  Script script({.max_gap_ticks = 0});
  EXPECT_EQ(script.wake(kMs).fault.code, Fault::overrun);
}

TEST(TickSchedule, TooManyMissedTicksInOneSecondAreAFault) {
  Script script({.max_gap_ticks = 5, .max_missed_per_s = 20});
  for (int i = 0; i < 20; ++i) ASSERT_EQ(script.wake(kMs).fault.code, Fault::none) << i;
  const Wake wake = script.wake(kMs);
  EXPECT_EQ(wake.fault.code, Fault::missed_rate);
  EXPECT_EQ(wake.fault.found, 21);
}

TEST(TickSchedule, MissedTicksAreForgottenAfterASecond) {
  Script script({.max_gap_ticks = 5, .max_missed_per_s = 20});
  for (int second = 0; second < 5; ++second) {
    for (int i = 0; i < 20; ++i) ASSERT_EQ(script.wake(kMs).fault.code, Fault::none);
    for (int i = 0; i < 1000; ++i) ASSERT_EQ(script.wake().fault.code, Fault::none);
  }
}

TEST(TickSchedule, EveryGapOfASecondCountsHoweverManyThereAre) {
  Script script({.period_ns = 125'000, .max_gap_ticks = 5, .max_missed_per_s = 3500});
  for (int i = 0; i < 3500; ++i) ASSERT_EQ(script.wake(125'000).fault.code, Fault::none) << i;
  EXPECT_EQ(script.wake(125'000).fault.code, Fault::missed_rate);
}

TEST(TickSchedule, SuspendIsAFaultHoweverLongItTook) {
  Script script;
  script.wake();
  script.boot += 2 * kSecond;  // boot time ran on, monotonic time stood still
  const Wake wake = script.wake();
  EXPECT_EQ(wake.fault.code, Fault::suspended);
  EXPECT_NEAR(wake.fault.found, 2.0, 1e-9);
  EXPECT_EQ(script.wake().fault.code, Fault::none) << "told once";
}

TEST(TickSchedule, ClockThatRunsBackwardsIsAFaultAndNoBurst) {
  Script script;
  script.wake();
  const std::int64_t before = script.schedule.next_ns();
  const Wake wake = script.wake(-5 * kSecond);
  EXPECT_EQ(wake.fault.code, Fault::clock_jump);
  EXPECT_EQ(wake.late_ns, 0);
  EXPECT_LT(script.schedule.next_ns(), before) << "goes on from the clock as it now is";
  const Wake next = script.wake();
  EXPECT_EQ(next.fault.code, Fault::none);
  EXPECT_EQ(next.tick, wake.tick + 1);
}

TEST(TickSchedule, MissedTicksAreBlamedOnThePhaseThatRanOver) {
  Script script;
  script.wake();
  EXPECT_FALSE(script.schedule.finished({10'000, 20'000, 30'000, 40'000}));
  EXPECT_EQ(script.wake(kMs).blamed, Phase::wake)
      << "the tick before was done in time: the wake-up was late";
  EXPECT_TRUE(script.schedule.finished({10'000, 20'000, 1'500'000, 1'600'000}));
  EXPECT_EQ(script.wake(kMs).blamed, Phase::step);
  EXPECT_TRUE(script.schedule.finished({10'000, 2'000'000, 2'100'000, 2'200'000}));
  EXPECT_EQ(script.wake(kMs).blamed, Phase::collect);
  EXPECT_TRUE(script.schedule.finished({10'000, 20'000, 30'000, 3'000'000}));
  EXPECT_EQ(script.wake(2 * kMs).blamed, Phase::command);
}

}  // namespace
}  // namespace hapticd::daemon
