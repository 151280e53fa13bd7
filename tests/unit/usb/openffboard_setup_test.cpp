#include "tests/unit/usb/openffboard_rig.h"

namespace hapticd::hid {
namespace {

using namespace test;

TEST(OpenFfboardDriver, IsSetUpWithoutForceAndWithNothingOfItsOwnActing) {
  BoardRig rig;
  for (int i = 0; i < 2; ++i) rig.board.position[i] = 1000;
  int force = 0;
  rig.board.every_frame = [&] { force = std::max(force, std::abs(rig.board.torque(0))); };
  ASSERT_TRUE(rig.open()) << rig.why();
  EXPECT_EQ(rig.opened->serial, "42");
  EXPECT_EQ(rig.host.asked.vendor, 0x1209);
  EXPECT_EQ(rig.host.asked.usage, 0x00010004U);
  for (const std::uint32_t command : {5U, 6U, 0x16U, 0x17U, 0x18U})
    EXPECT_EQ(rig.board.setting(0xa01, 0, command), 0) << command;
  EXPECT_EQ(rig.board.setting(0xa01, 0, 0x0c), 255);
  EXPECT_EQ(rig.board.setting(0xa02, 0, 0), 500);
  EXPECT_FALSE(rig.board.active);
  EXPECT_EQ(force, 0);
  EXPECT_TRUE(rig.board.effects[0].made);
  EXPECT_EQ(rig.board.effects[0].duration_ms, 100);
}

TEST(OpenFfboardDriver, AsksBeforeItChangesAnythingAndDisablesLast) {
  BoardRig rig;
  ASSERT_TRUE(rig.open()) << rig.why();
  EXPECT_EQ(rig.first("a101010a0001"), 0U) << "degrees come first";
  const std::size_t first_write = rig.first("a100");
  EXPECT_LT(rig.first("a101010a0005"), first_write);
  EXPECT_LT(first_write, rig.first("0c08"));
  EXPECT_LT(rig.first("0c08"), rig.first("1101"));
  EXPECT_LT(rig.first("1101"), rig.first("0101"));
  EXPECT_LT(rig.first("0dff"), rig.board.log.size());
  EXPECT_EQ(usb::hex(rig.board.log.back().report), "0c02");
  EXPECT_TRUE(rig.board.replaced.empty());
  EXPECT_GE(rig.protocol->round_trip_s(), 0.001);
  EXPECT_LE(rig.protocol->round_trip_s(), 0.004);
}

TEST(OpenFfboardDriver, TheFilterIsOffAtAnyRate) {
  BoardRig rig;
  rig.board.rate_Hz = 8000;
  ASSERT_TRUE(rig.open()) << rig.why();
  EXPECT_EQ(rig.board.setting(0xa02, 0, 0), 4000);
}

TEST(OpenFfboardDriver, CloseLeavesTheBoardWithoutForceAndAsItWas) {
  BoardRig rig({.axes = 2}, board_options(2));
  const auto before = rig.board.settings;
  ASSERT_TRUE(rig.open()) << rig.why();
  rig.arm();
  rig.ticks(50, true, {2, -2});
  ASSERT_NE(rig.board.torque(0), 0);
  const std::int64_t begin_ns = rig.board.now_ns;
  rig.board.log.clear();
  rig.protocol->close(rig.host, begin_ns + 100 * kFrame_ns);
  EXPECT_FALSE(rig.board.opened);
  EXPECT_EQ(rig.board.settings, before);
  EXPECT_FALSE(rig.board.active);
  EXPECT_FALSE(rig.board.effects[0].plays || rig.board.effects[1].plays);
  EXPECT_LE(rig.board.now_ns, begin_ns + 100 * kFrame_ns);
  EXPECT_LT(rig.first("0c02"), rig.first("a100")) << "first the force, then the settings";
  EXPECT_EQ(usb::hex(rig.board.log.back().report).substr(0, 12), "a100010a0005")
      << "the spring comes last";
  EXPECT_EQ(rig.protocol->port(), nullptr);
}

TEST(OpenFfboardDriver, CloseWithoutTimeStillSaysZeroFirst) {
  BoardRig rig;
  ASSERT_TRUE(rig.open()) << rig.why();
  rig.arm();
  rig.ticks(10, true, {2, 0});
  rig.board.log.clear();
  rig.protocol->close(rig.host, rig.board.now_ns + 5 * kFrame_ns);
  EXPECT_FALSE(rig.board.active);
  EXPECT_EQ(rig.board.torque(0), 0);
}

TEST(OpenFfboardDriver, AnotherRangeThanConfiguredIsRefusedAndNothingIsChanged) {
  BoardRig rig;
  rig.board.settings[FakeBoard::key(0xa01, 0, 1)] = 1080;
  const auto before = rig.board.settings;
  EXPECT_FALSE(rig.open());
  EXPECT_NE(rig.why().find("expected encoder.counts_per_rev 21845.33"), std::string::npos)
      << rig.why();
  EXPECT_NE(rig.why().find("found 26214.4"), std::string::npos) << rig.why();
  EXPECT_EQ(rig.board.settings, before);
  EXPECT_EQ(rig.count("a100") + rig.count("0c"), 0);
  EXPECT_FALSE(rig.board.opened);
}

TEST(OpenFfboardDriver, ARangeIsTheSameWithinAThousandth) {
  for (const auto& [factor, good] :
       {std::pair{1.0009, true}, {0.9991, true}, {1.0011, false}, {0.9989, false}, {-1.0, true}}) {
    BoardRig rig({}, board_options(1, factor * 65536 * 360 / 900));
    EXPECT_EQ(rig.open(), good) << factor;
  }
}

TEST(OpenFfboardDriver, WhatDoesNotFitIsRefusedInWords) {
  BoardRig two({.axes = 1}, board_options(2));
  EXPECT_FALSE(two.open());
  EXPECT_NE(two.why().find("expected 2 axes with force as configured, found 1"), std::string::npos)
      << two.why();
  BoardRig other;
  other.board.descriptor = usb::bytes("06abff0a0002a1017508150026ff00954009018102954009029102c0");
  EXPECT_FALSE(other.open());
  EXPECT_NE(other.why().find("expected report 2 (state) with 2 bytes, found 0"), std::string::npos)
      << other.why();
  BoardRig torn;
  torn.board.descriptor.pop_back();
  EXPECT_FALSE(torn.open());
  EXPECT_NE(torn.why().find("not closed"), std::string::npos) << torn.why();
  BoardRig full;
  full.board.effects.clear();
  const auto before = full.board.settings;
  EXPECT_FALSE(full.open());
  EXPECT_NE(full.why().find("expected room for a constant force"), std::string::npos) << full.why();
  EXPECT_EQ(full.board.settings, before) << "what was set is as it was";
}

TEST(OpenFfboardDriver, AMuteBoardIsGivenUp) {
  BoardRig rig;
  rig.board.mute = true;
  EXPECT_FALSE(rig.open());
  EXPECT_NE(rig.why().find("expected an answer to degrees"), std::string::npos) << rig.why();
  EXPECT_LT(rig.board.now_ns, 3'000'000'000);
}

TEST(OpenFfboardDriver, SettingsThatAnOlderFirmwareDoesNotHaveAreLeftOut) {
  BoardRig rig;
  for (const std::uint32_t command : {0x16U, 0x17U, 0x18U})
    rig.board.settings.erase(FakeBoard::key(0xa01, 0, command));
  rig.board.settings.erase(FakeBoard::key(1, 0, 0));  // nor does it say whether forces are on
  ASSERT_TRUE(rig.open()) << rig.why();
  rig.wait_for_position();
  rig.ticks(30, true, {2, 0});
  EXPECT_TRUE(rig.reading.armed) << "its state says so";
  EXPECT_EQ(rig.board.torque(0), kHalf);
}

TEST(OpenFfboardDriver, UnpluggedAtAnyCallItIsNotOpenedOrClosesWithoutHarm) {
  BoardRig whole({.axes = 2}, board_options(2));
  ASSERT_TRUE(whole.open());
  const int calls = whole.board.calls;
  ASSERT_GT(calls, 100);
  for (int at = 0; at < calls; ++at) {
    BoardRig rig({.axes = 2}, board_options(2));
    rig.board.unplug_at = at;
    ASSERT_FALSE(rig.open()) << at;
    ASSERT_FALSE(rig.why().empty());
    ASSERT_FALSE(rig.board.opened) << at;
    ASSERT_LT(rig.board.now_ns, 2'000'000'000) << at;
  }
  for (int after = 0; after < 400; after += 7) {
    BoardRig rig({.axes = 2}, board_options(2));
    ASSERT_TRUE(rig.open());
    rig.board.unplug_at = rig.board.calls + after;
    for (int i = 0; i < 100 && rig.status == usb::Status::ok; ++i) rig.tick(true, {1, 1});
    rig.protocol->close(rig.host, rig.board.now_ns + 20 * kFrame_ns);
    ASSERT_FALSE(rig.board.opened);
  }
}

}  // namespace
}  // namespace hapticd::hid
