// The bus: time, order, loss.
#include "sim/can/emulated_bus.h"

#include <gtest/gtest.h>

#include "sim/can/bus_time.h"
#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;

std::int64_t time_of(const Frame& frame) {
  return bus_time_ns(frame, {});
}

TEST(BusTime, ClassicFramesLieBetweenNoStuffingAndTheWorst) {
  const Json& all = vectors().at("bus_time").at("classic");
  ASSERT_GE(all.size(), 9U);
  for (const Json& vector : all) {
    const double least =
        vector.at("bits_incl_interframe").get<double>() - vector.at("stuff_bits").get<double>();
    const double bits = static_cast<double>(time_of(frame_of(vector))) / 1000;
    EXPECT_GE(bits, least) << vector.dump();
    EXPECT_LE(bits, vector.at("worst_case_bits")) << vector.dump();
  }
}

TEST(BusTime, FdFramesLieWithinTheBounds) {
  for (const Json& vector : vectors().at("bus_time").at("fd_bounds")) {
    Frame frame{};
    frame.can_id = vector.at("extended") ? CAN_EFF_FLAG : 0U;
    frame.len = vector.at("len");
    frame.flags = CANFD_FDF | CANFD_BRS;
    const double us = static_cast<double>(time_of(frame)) / 1000;
    EXPECT_GE(us, vector.at("min_us")) << vector.dump();
    EXPECT_LE(us, vector.at("worst_us")) << vector.dump();
    frame.flags = CANFD_FDF;
    EXPECT_GT(static_cast<double>(time_of(frame)) / 1000, 2 * us - 60);
  }
}

TEST(BusTime, ArbitrationIsWonBitByBit) {
  const Frame low = classic_frame(0x100, 0), high = classic_frame(0x101, 0);
  EXPECT_LT(arbitration_key(low), arbitration_key(high));
  EXPECT_LT(arbitration_key(low), arbitration_key(classic_frame(0x100 | CAN_RTR_FLAG, 0)));
  const Frame extended = classic_frame((0x100U << 18) | CAN_EFF_FLAG, 0);
  EXPECT_LT(arbitration_key(low), arbitration_key(extended));
  EXPECT_LT(arbitration_key(extended), arbitration_key(high));
}

struct BusOfOne {
  HostEnd host;
  EmulatedBus bus;
  EchoDrive drive;
  explicit BusOfOne(const WireOptions& options = {}, std::int64_t turnaround_ns = 0)
      : bus(host.bus_fd(), options), drive(0x300, turnaround_ns) {
    bus.add(drive);
    bus.advance(0);
  }
};

TEST(EmulatedBus, FramesOccupyTheBusInTurn) {
  BusOfOne b({}, 50 * kUs);
  const Frame frame = data_frame(0x10, "0102030405060708");
  b.host.write(frame);
  b.host.write(frame);
  b.bus.advance(kMs);
  EXPECT_TRUE(b.drive.heard.empty());
  const std::int64_t once = time_of(frame);
  EXPECT_EQ(b.bus.next_ns(), kMs + once);
  b.bus.advance(kMs + once - 1);
  EXPECT_TRUE(b.drive.heard.empty());
  b.bus.advance(2 * kMs);
  ASSERT_EQ(b.drive.heard.size(), 2U);
  EXPECT_EQ(b.drive.heard[0].first, kMs + once);
  EXPECT_EQ(b.drive.heard[1].first, kMs + 2 * once);
  EXPECT_EQ(b.host.read_all().size(), 2U);
  EXPECT_EQ(b.bus.received(), 2U);
  EXPECT_EQ(b.bus.sent(), 2U);
  EXPECT_EQ(b.bus.next_ns(), kNever);
}

TEST(EmulatedBus, AnswersComeAfterTurnaroundAndBusTimeAndNotBefore) {
  BusOfOne b({}, 50 * kUs);
  const Frame frame = data_frame(0x10, "01");
  b.host.write(frame);
  b.bus.advance(0);
  const std::int64_t due = 2 * time_of(frame) + 50 * kUs;
  b.bus.advance(due - 1);
  EXPECT_TRUE(b.host.read_all().empty());
  EXPECT_EQ(b.bus.next_ns(), due);
  b.bus.advance(due);
  const auto frames = b.host.read_all();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0].can_id, 0x300U);
  EXPECT_EQ(hex_of(frames[0]), "01");
}

TEST(EmulatedBus, NextNsLeadsFromEventToEvent) {
  BusOfOne b;
  b.drive.timer_ns = 5 * kMs;
  EXPECT_EQ(b.bus.next_ns(), 5 * kMs);
  b.bus.advance(5 * kMs);
  const std::int64_t end = b.bus.next_ns();
  EXPECT_EQ(end, 5 * kMs + time_of(classic_frame(0x300, 0)));
  b.bus.advance(end);
  EXPECT_EQ(b.host.read_all().size(), 1U);
}

TEST(EmulatedBus, TimersInOneLongAdvanceSendAtTheirOwnTimes) {
  BusOfOne b;
  EchoDrive other(0x200);
  b.bus.add(other);
  b.drive.timer_ns = 1 * kMs;
  other.timer_ns = 2 * kMs;
  b.drive.answers = other.answers = false;
  b.bus.advance(10 * kMs);
  EXPECT_EQ(ids_of(b.host.read_all()), (std::vector<std::uint32_t>{0x300, 0x200}));
  EXPECT_EQ(other.heard.at(0).first, kMs + time_of(classic_frame(0x300, 0)));
}

TEST(EmulatedBus, OfThoseWaitingTheLowestIdGoesFirst) {
  BusOfOne b;
  EchoDrive other(0x200);
  b.bus.add(other);
  b.drive.answers = other.answers = false;
  b.drive.timer_ns = other.timer_ns = kMs;
  b.bus.advance(2 * kMs);
  EXPECT_EQ(ids_of(b.host.read_all()), (std::vector<std::uint32_t>{0x200, 0x300}));
}

TEST(EmulatedBus, AHostFrameWaitsForTheBus) {
  BusOfOne b;
  b.drive.timer_ns = kMs;
  b.drive.answers = false;
  b.bus.advance(kMs);
  b.host.write(data_frame(0x10, ""));
  b.bus.advance(kMs);
  b.bus.advance(2 * kMs);
  EXPECT_EQ(b.drive.heard.at(0).first, kMs + 2 * time_of(classic_frame(0, 0)));
}

TEST(EmulatedBus, ANewerAnswerReplacesOneThatIsStillWaitingWhereTheDriveDoesSo) {
  for (const bool newest : {false, true}) {
    BusOfOne b({}, 5 * kMs);
    b.drive.newest = newest;
    b.host.write(data_frame(0x10, "01"));
    b.host.write(data_frame(0x10, "02"));
    b.bus.advance(0);
    b.bus.advance(20 * kMs);
    const auto frames = b.host.read_all();
    EXPECT_EQ(frames.size(), newest ? 1U : 2U);
    EXPECT_EQ(hex_of(frames.back()), "02");
  }
}

TEST(EmulatedBus, OnlyFramesOfTheKernelsSizesAreHeard) {
  BusOfOne b;
  Frame frame = data_frame(0x10, "01");
  b.host.write_bytes(&frame, 15);
  b.host.write_bytes(&frame, 17);
  b.host.write_bytes(&frame, 71);
  frame.len = 9;
  b.host.write(frame);  // classic, too long
  b.host.write(fd_frame(0x10, std::string(26, '0')));
  b.host.write(fd_frame(0x10, std::string(24, '0')));
  b.bus.advance(0);
  b.bus.advance(kMs);
  ASSERT_EQ(b.drive.heard.size(), 1U);
  EXPECT_EQ(b.drive.heard[0].second.len, 12);
  EXPECT_EQ(b.drive.heard[0].second.flags, CANFD_FDF | CANFD_BRS);
  EXPECT_EQ(b.bus.received(), 1U);
  EXPECT_EQ(b.bus.refused(), 5U);
  const auto frames = b.host.read_all();
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(is_fd(frames[0]));
}

TEST(EmulatedBus, ASizeOfFdIsFdWhateverTheFlagsSay) {
  BusOfOne b;
  Frame frame = data_frame(0x10, "01");
  b.host.write_bytes(&frame, CANFD_MTU);
  b.bus.advance(0);
  b.bus.advance(kMs);
  EXPECT_TRUE(is_fd(b.drive.heard.at(0).second));
}

TEST(EmulatedBus, LosesAndSwapsWhatItIsTold) {
  BusOfOne b;
  b.bus.lose_next(1);
  for (const char* hex : {"01", "02", "03", "04"}) b.host.write(data_frame(0x10, hex));
  b.bus.advance(0);
  b.bus.reorder_next();
  b.bus.advance(kMs);
  std::vector<std::string> found;
  for (const Frame& frame : b.host.read_all()) found.push_back(hex_of(frame));
  EXPECT_EQ(found, (std::vector<std::string>{"03", "02", "04"}));
  EXPECT_EQ(b.drive.heard.size(), 4U);
}

// What of 300 frames to a drive that echoes them comes back.
std::vector<std::string> echoes(const WireOptions& options) {
  BusOfOne b(options);
  std::vector<std::string> found;
  for (unsigned i = 0; i < 300; ++i) {
    b.host.write(data_frame(0x10, hex_le(static_cast<std::uint16_t>(i))));
    b.bus.advance(i * kMs);
    for (const Frame& frame : b.host.read_all()) found.push_back(hex_of(frame));
  }
  return found;
}

TEST(EmulatedBus, ChanceIsTheSeedsAlone) {
  const WireOptions options{.loss = 0.1, .duplicate = 0.1, .jitter_s = 2e-3, .seed = 7};
  WireOptions other = options;
  other.seed = 8;
  EXPECT_EQ(echoes(options), echoes(options));
  EXPECT_NE(echoes(options), echoes(other));
}

TEST(EmulatedBus, LossAndDuplicationHaveTheirShares) {
  EXPECT_EQ(echoes({}).size(), 299U);  // the last one is on its way
  const auto lost = static_cast<double>(echoes({.loss = 0.2}).size());
  EXPECT_NEAR(lost, 300 * 0.64, 40);
  const auto doubled = static_cast<double>(echoes({.duplicate = 0.2}).size());
  EXPECT_NEAR(doubled, 300 * 1.44, 50);
}

TEST(EmulatedBus, TheAdapterDelaysBothWaysAndKeepsTheOrder) {
  BusOfOne b({.delay_s = 2e-3});
  const Frame frame = data_frame(0x10, "01");
  b.host.write(frame);
  b.bus.advance(0);
  const std::int64_t due = 4 * kMs + 2 * time_of(frame);
  b.bus.advance(due - 1);
  EXPECT_EQ(b.drive.heard.at(0).first, 2 * kMs + time_of(frame));
  EXPECT_TRUE(b.host.read_all().empty());
  b.bus.advance(due);
  EXPECT_EQ(b.host.read_all().size(), 1U);
  const auto found = echoes({.jitter_s = 3e-3});
  EXPECT_GT(found.size(), 280U);
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const auto& x, const auto& y) {
    return x.substr(2) + x.substr(0, 2) < y.substr(2) + y.substr(0, 2);
  }));
}

TEST(EmulatedBus, InjectsToTheHostAloneAtItsTime) {
  BusOfOne b;
  b.bus.inject(data_frame(0x20, "aa"), 3 * kMs);
  Frame error = classic_frame(CAN_ERR_FLAG | 0x40, 8);
  b.bus.inject(error, 4 * kMs);
  EXPECT_EQ(b.bus.next_ns(), 3 * kMs);
  b.bus.advance(2 * kMs);
  EXPECT_TRUE(b.host.read_all().empty());
  b.bus.advance(5 * kMs);
  const auto frames = b.host.read_all();
  ASSERT_EQ(frames.size(), 2U);
  EXPECT_EQ(hex_of(frames[0]), "aa");
  EXPECT_TRUE(is_error(frames[1]));
  EXPECT_TRUE(b.drive.heard.empty());
}

TEST(EmulatedBus, WhatTheHostCannotTakeIsDroppedAndCounted) {
  BusOfOne b;
  for (int i = 0; i < 2000; ++i) b.bus.inject(data_frame(0x20, "aa"), kMs);
  b.bus.advance(kMs);
  EXPECT_GT(b.bus.dropped(), 0U);
  EXPECT_EQ(b.bus.dropped() + b.bus.sent(), 2000U);
  EXPECT_EQ(b.host.read_all().size(), b.bus.sent());
}

TEST(EmulatedBus, AMutedDriveIsNotHeard) {
  BusOfOne b;
  b.drive.mute(true);
  b.host.write(data_frame(0x10, "01"));
  b.bus.advance(0);
  b.bus.advance(kMs);
  EXPECT_EQ(b.drive.heard.size(), 1U);
  EXPECT_TRUE(b.host.read_all().empty());
}

}  // namespace
}  // namespace hapticd::test::emulator
