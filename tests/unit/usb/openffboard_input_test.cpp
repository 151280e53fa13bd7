#include "drivers/hid/openffboard_codec.h"
#include "tests/unit/usb/openffboard_rig.h"

namespace hapticd::hid {
namespace {

using namespace test;

TEST(OpenFfboardDriver, PositionsAreTheRawNumbersOfAnyBuild) {
  for (const bool wide : {false, true}) {
    const double range = wide ? 4294967296.0 : 65536.0;
    BoardRig rig({.axes = 2, .wide = wide}, board_options(2, range * 360 / 900));
    ASSERT_TRUE(rig.open()) << rig.why();
    rig.board.position[0] = wide ? -2'000'000'000 : -32000;
    rig.board.position[1] = 4711;
    rig.ticks(5, false);
    EXPECT_EQ(rig.reading.counts[0], static_cast<double>(rig.board.position[0]));
    EXPECT_EQ(rig.reading.counts[1], 4711);
    EXPECT_EQ(rig.reading.homed, 3);
  }
}

TEST(OpenFfboardDriver, AWideBuildWithFewerBitsHasItsOwnRange) {
  BoardRig rig({.wide = true, .most = (1 << 23) - 1}, board_options(1, 16777216 * 360.0 / 900));
  EXPECT_TRUE(rig.open()) << rig.why();
}

TEST(OpenFfboardDriver, ButtonsAndOtherAxesAreInputs) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  EXPECT_EQ(rig.take("01"
                     "05000080ffffffff"
                     "e803"
                     "ff7f"
                     "0180"
                     "0000"
                     "0000"
                     "0000"
                     "0000"
                     "0000"),
            Heard::sample);
  EXPECT_EQ(rig.reading.digital, 0x80000005U);
  EXPECT_EQ(rig.reading.counts[0], 1000);
  EXPECT_EQ(rig.reading.analogue[0], 1);
  EXPECT_EQ(rig.reading.analogue[1], -1);
}

TEST(OpenFfboardDriver, WrongLengthsAreMalformedAndOtherReportsNothing) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  EXPECT_EQ(rig.take(""), Heard::malformed);
  EXPECT_EQ(rig.take("0100"), Heard::malformed);
  EXPECT_EQ(rig.take("02"), Heard::malformed);
  EXPECT_EQ(rig.take("020000"), Heard::malformed);
  EXPECT_EQ(rig.take("a101"), Heard::malformed);
  EXPECT_EQ(rig.take("77"), Heard::nothing);
  const auto other = openffboard::encode({.type = openffboard::Type::read, .class_id = 0xa01});
  EXPECT_EQ(rig.protocol->take(other, rig.board.now_ns, rig.reading), Heard::nothing);
}

TEST(OpenFfboardDriver, SamplesStayYoungWhileNothingMovesAndEndWithThePositions) {
  for (const bool armed : {false, true}) {
    BoardRig rig;
    ASSERT_TRUE(rig.open());
    rig.wait_for_position();
    if (armed) rig.arm();
    rig.ticks(20, armed);
    std::int64_t oldest_ns = 0;
    for (int i = 0; i < 500; ++i) {
      rig.tick(armed, {armed ? 1.0 : 0.0, 0});
      oldest_ns = std::max(oldest_ns, rig.board.now_ns - rig.sample_ns);
    }
    EXPECT_LE(oldest_ns, 5 * kFrame_ns) << armed;
    rig.board.frozen = true;
    rig.ticks(300, armed);
    EXPECT_GE(rig.board.now_ns - rig.sample_ns, 145 * kFrame_ns) << "answers alone are no samples";
  }
}

TEST(OpenFfboardDriver, TheEmergencyStopIsAFaultWhileForcesAreWanted) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.board.emergency = true;
  rig.ticks(100, false);
  EXPECT_EQ(rig.faults, 0);
  EXPECT_EQ(rig.reading.drive_faults & openffboard::kEmergencyStop, openffboard::kEmergencyStop);
  rig.board.emergency = false;
  rig.ticks(100, false);
  rig.arm();
  rig.board.emergency = true;
  rig.ticks(60, true);
  EXPECT_GT(rig.faults, 0);
  EXPECT_NE(rig.protocol->fault_text().find("emergency stop"), std::string_view::npos);
  EXPECT_FALSE(rig.reading.armed);
  rig.board.emergency = false;
  rig.ticks(100, false);
  rig.faults = 0;
  rig.arm();
  rig.ticks(100, true);
  EXPECT_EQ(rig.faults, 0);
}

TEST(OpenFfboardDriver, TheSafetySwitchIsOne) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.arm();
  rig.board.put_in({2, 0x1e});
  rig.ticks(3, true);
  EXPECT_GT(rig.faults, 0);
  EXPECT_NE(rig.protocol->fault_text().find("safety switch"), std::string_view::npos);
}

TEST(OpenFfboardDriver, ForcesThatSomebodyElseSwitchedOffAreAFault) {
  BoardRig rig;
  ASSERT_TRUE(rig.open());
  rig.arm();
  rig.board.active = false;
  rig.ticks(60, true, {1, 0});
  EXPECT_GT(rig.faults, 0);
  EXPECT_NE(rig.protocol->fault_text().find("switched its force off"), std::string_view::npos);
  EXPECT_FALSE(rig.board.active) << "and are not switched on again unasked";
}

}  // namespace
}  // namespace hapticd::hid
