#include <gtest/gtest.h>

#include "daemon/alarms.h"

namespace hapticd::daemon {
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

TEST(RateLimitedCount, TellsTheFirstAtOnceAndTheRestOnceAMinute) {
  RateLimitedCount alarm;
  EXPECT_EQ(alarm.due(0, 0), std::nullopt);
  EXPECT_EQ(alarm.due(3, kSecond_ns), 3u);
  EXPECT_EQ(alarm.due(5, 2 * kSecond_ns), std::nullopt);
  EXPECT_EQ(alarm.due(9, 60 * kSecond_ns), std::nullopt);
  EXPECT_EQ(alarm.due(9, 61 * kSecond_ns), 6u);
}

TEST(RateLimitedCount, IsQuietWhereNothingIsNew) {
  RateLimitedCount alarm;
  EXPECT_EQ(alarm.due(1, 0), 1u);
  EXPECT_EQ(alarm.due(1, 1000 * kSecond_ns), std::nullopt);
}

TEST(Heartbeat, TellsSilenceOnceAndComingBackOnce) {
  using Change = Heartbeat::Change;
  Heartbeat heartbeat(0);
  EXPECT_EQ(heartbeat.look(1, kSecond_ns / 2), Change::none);
  EXPECT_EQ(heartbeat.look(1, kSecond_ns), Change::none);
  EXPECT_EQ(heartbeat.look(1, 2 * kSecond_ns), Change::went_silent);
  EXPECT_EQ(heartbeat.look(1, 3 * kSecond_ns), Change::none);
  EXPECT_EQ(heartbeat.look(2, 4 * kSecond_ns), Change::came_back);
  EXPECT_EQ(heartbeat.look(3, 5 * kSecond_ns), Change::none);
}

}  // namespace
}  // namespace hapticd::daemon
