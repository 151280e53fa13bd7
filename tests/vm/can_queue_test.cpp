// Queues of the kernel: full ones, lossy ones, one that nobody empties; and when a frame came.
#include <gtest/gtest.h>

#include <ctime>
#include <iostream>
#include <numeric>

#include "tests/vm/kernel_can.h"
#include "tests/vm/links.h"

namespace hapticd::test {
namespace {

using can::Socket;

std::vector<can::Frame> numbered(std::uint32_t count) {
  std::vector<can::Frame> frames;
  for (std::uint32_t i = 0; i < count; ++i) frames.push_back(frame(i, {1, 2, 3, 4, 5, 6, 7, 8}));
  return frames;
}
std::vector<std::uint32_t> first(std::size_t count) {
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0U);
  return ids;
}

/// 16 bytes at 100 kbit/s: 1.28 ms a frame.
TEST(CanQueue, WhatTheKernelDoesNotTakeIsGone) {
  Link link("queue0");
  Socket from = open_all(link.name()), to = open_all(link.name());
  link.netem("rate 100kbit limit 5");
  const std::int64_t start_ns = now_ns();
  const std::size_t taken = from.send(numbered(20));
  EXPECT_GE(taken, 5U);
  EXPECT_LE(taken, 7U);
  EXPECT_EQ(from.counters().sent, taken);
  EXPECT_EQ(from.counters().not_sent, 20 - taken);
  EXPECT_EQ(from.trouble(), can::Trouble::none) << "a full queue is no fault of the interface";
  const auto heard = hear(to, 60);
  EXPECT_EQ(ids_of(heard), first(taken)) << "nothing comes later, nothing is tried again";
  if (!heard.empty()) {
    EXPECT_LT(heard.back().stamp_ns - start_ns, static_cast<std::int64_t>(taken + 1) * 1'280'000);
  }
  const can::Frame later = frame(0x55);
  EXPECT_EQ(from.send({&later, 1}), 1U);
  EXPECT_EQ(ids_of(hear(to)), std::vector<std::uint32_t>{0x55});
}

/// A loop that goes on while the bus is slow: what comes is at most a queue old.
TEST(CanQueue, AFullQueueKeepsNoMoreThanItsLength) {
  Link link("queue0");
  Socket from = open_all(link.name()), to = open_all(link.name());
  link.netem("rate 10kbit limit 5");  // 12.8 ms a frame
  for (std::uint32_t tick = 0; tick < 100; ++tick) {
    const can::Frame sent = frame(tick);
    from.send({&sent, 1});
    pause_ms(1);
  }
  const std::size_t during = to.receive(now_ns()).size();
  const std::size_t after = hear(to, 100).size();
  EXPECT_GE(during, 5U);
  EXPECT_LE(after, 7U);
  EXPECT_EQ(from.counters().sent, during + after);
  EXPECT_EQ(from.counters().sent + from.counters().not_sent, 100U);
  EXPECT_EQ(from.trouble(), can::Trouble::none);
}

TEST(CanQueue, LostOnTheWayIsNotKnownToTheSender) {
  Link link("queue0");
  Socket from = open_all(link.name()), to = open_all(link.name());
  link.netem("loss 30%");
  std::size_t heard = 0;
  for (int i = 0; i < 400; ++i) {
    const can::Frame sent = frame(1);
    from.send({&sent, 1});
    if (i % 20 == 0) heard += hear(to, 1).size();
  }
  heard += hear(to).size();
  EXPECT_EQ(from.counters().sent, 400U);
  EXPECT_EQ(from.counters().not_sent, 0U);
  EXPECT_GT(heard, 200U);
  EXPECT_LT(heard, 360U);
  EXPECT_EQ(from.trouble(), can::Trouble::none);
}

TEST(CanQueue, ASocketThatNobodyEmptiesLosesTheNewestAndCounts) {
  const Link link("queue0");
  Socket from = open_all(link.name()), to = open_all(link.name());
  constexpr std::uint32_t kSent = 600;
  for (const can::Frame& one : numbered(kSent)) {
    ASSERT_EQ(from.send({&one, 1}), 1U);
    if (one.id % 50 == 0) pause_ms(1);
  }
  const auto heard = hear(to);
  EXPECT_EQ(ids_of(heard), first(heard.size())) << "the oldest are kept";
  EXPECT_GT(heard.size(), 100U);
  ASSERT_LT(heard.size(), kSent);
  // The kernel tells with the next frame that fits.
  const can::Frame next = frame(0x700);
  from.send({&next, 1});
  EXPECT_EQ(ids_of(hear(to)), std::vector<std::uint32_t>{0x700});
  EXPECT_GT(to.counters().lost, 0U);
  EXPECT_LE(to.counters().lost, kSent - heard.size());
  std::cout << "# queue: " << heard.size() << " frames held, " << kSent - heard.size()
            << " lost, of which " << to.counters().lost << " are known\n";
}

class CanStamps : public testing::Test {
 protected:
  struct Times {
    std::int64_t sent_ns = 0, stamp_ns = 0, taken_ns = 0;
  };
  /// Sent, left in the kernel for a while, taken.
  Times pass(int wait_ms) {
    const can::Frame sent = frame(1);
    Times times;
    times.sent_ns = now_ns();
    from.send({&sent, 1});
    if (wait_ms > 0) pause_ms(wait_ms);
    times.taken_ns = now_ns();
    const auto heard = to.receive(times.taken_ns);
    if (heard.size() != 1) throw std::runtime_error("not one frame");
    times.stamp_ns = heard[0].stamp_ns;
    return times;
  }
  /// The kernel begins to stamp a moment after it is asked to, and clocks are compared by frames.
  void warm_up() {
    for (int i = 0; i < 50; ++i) {
      pass(0);
      pause_ms(1);
    }
  }

  const Link link{"stamps0"};
  Socket from = open_all(link.name()), to = open_all(link.name());
};

TEST_F(CanStamps, LieBetweenSendingAndTaking) {
  for (int i = 0; i < 200; ++i) {
    const Times times = pass(i % 4);
    ASSERT_GE(times.stamp_ns, times.sent_ns) << i;
    ASSERT_LE(times.stamp_ns, times.taken_ns) << i;
  }
}

TEST_F(CanStamps, TellWhenAFrameCameThatWasTakenLate) {
  warm_up();
  std::int64_t worst_ns = 0;
  for (int i = 0; i < 20; ++i) {
    const Times times = pass(20);
    worst_ns = std::max(worst_ns, times.stamp_ns - times.sent_ns);
  }
  EXPECT_LT(worst_ns, 200'000);
  std::cout << "# stamps: at most " << worst_ns / 1000 << " us after sending\n";
}

/// NTP, or a person, sets the clock of the day.
TEST_F(CanStamps, DoNotFollowTheClockOfTheDay) {
  warm_up();
  for (const int step_s : {-5, 5}) {
    timespec time{};
    ASSERT_EQ(clock_gettime(CLOCK_REALTIME, &time), 0);
    time.tv_sec += step_s;
    ASSERT_EQ(clock_settime(CLOCK_REALTIME, &time), 0);
    for (int i = 0; i < 20; ++i) {
      const Times times = pass(2);
      ASSERT_LE(times.stamp_ns, times.taken_ns) << step_s;
      ASSERT_GE(times.stamp_ns, times.sent_ns) << step_s;
      ASSERT_LT(times.stamp_ns - times.sent_ns, 500'000) << step_s;
    }
  }
}

}  // namespace
}  // namespace hapticd::test
