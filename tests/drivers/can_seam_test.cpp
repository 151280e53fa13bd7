// What a device on a CAN bus does when all is well: it finds its drives, arms them, renders, and leaves them off.
#include <gtest/gtest.h>

#include <numbers>

#include "tests/drivers/can_configs.h"
#include "tests/drivers/can_rig.h"

namespace hapticd::test {
namespace {

using control::Mode;

constexpr double kTurnsPerMetre = 20;

/// Force at the axis that the motor makes.
double force_N(CanRig& rig, std::size_t axis = 0) {
  return rig.motor_Nm(axis) * 2 * std::numbers::pi * kTurnsPerMetre;
}

Emulation usual() {
  Emulation emulation;
  emulation.cia402.rated_torque_Nm = 0.1;
  return emulation;
}

class CanSeam : public testing::TestWithParam<Bus> {};

std::string name_of(const testing::TestParamInfo<Bus>& info) {
  return std::string(info.param.driver) + "_" + info.param.timing;
}
INSTANTIATE_TEST_SUITE_P(All, CanSeam, testing::ValuesIn(kBuses), name_of);

TEST_P(CanSeam, ArmsAndHoldsAHandOnAWall) {
  CanRig rig(wall_on(GetParam()), usual());
  const auto info = rig.connect();
  ASSERT_TRUE(info) << info.error().text;
  EXPECT_EQ(rig.device().lock_names(), std::vector<std::string>{"can-can0-3"});
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(rig.tick().mode, Mode::idle);
    EXPECT_EQ(rig.motor_Nm(), 0);
  }
  EXPECT_FALSE(rig.drives().drive(0).enabled());
  ASSERT_TRUE(rig.enable()) << rig.fault_text();
  EXPECT_TRUE(rig.drives().drive(0).enabled());
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(rig.tick().mode, Mode::enabled) << rig.fault_text();
  // The hand pushes with 1 N: the wall gives as much back, 1 N / (300 N/m) deep.
  EXPECT_NEAR(force_N(rig), 1, 0.02);
  EXPECT_NEAR(rig.drives().body().position(0), -1.0 / 300, 5e-5);
  EXPECT_NEAR(rig.program().state().q[0], rig.drives().body().position(0), 2e-5);
  rig.input.enable = false;
  ASSERT_TRUE(rig.run_until([&] { return rig.mode() == Mode::idle; }, 300));
  for (int i = 0; i < 3; ++i) rig.tick();
  EXPECT_FALSE(rig.drives().drive(0).enabled());
  EXPECT_EQ(rig.motor_Nm(), 0);
}

TEST_P(CanSeam, ThreeAxesOnTwoBusesEachTheirOwnWay) {
  CanRig rig(three_axes(GetParam()), usual());
  const auto info = rig.connect();
  ASSERT_TRUE(info) << info.error().text;
  ASSERT_TRUE(rig.enable()) << rig.fault_text();
  for (int i = 0; i < 2000; ++i) ASSERT_EQ(rig.tick().mode, Mode::enabled) << rig.fault_text();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(force_N(rig, axis), axis == 1 ? -1 : 1, 0.02) << axis;
    EXPECT_NEAR(rig.program().state().q[axis], -1.0 / 300, 5e-5) << axis;
  }
}

TEST_P(CanSeam, MayBeArmedBeforeTheFirstTick) {
  CanRig rig(wall_on(GetParam()), usual());
  ASSERT_TRUE(rig.connect());
  rig.device().set_armed(true);
  EXPECT_TRUE(rig.enable()) << rig.fault_text();
}

TEST_P(CanSeam, LeavesTheDrivesOffWhenItDisconnects) {
  CanRig rig(wall_on(GetParam()), usual());
  ASSERT_TRUE(rig.connect());
  ASSERT_TRUE(rig.enable());
  for (int i = 0; i < 300; ++i) rig.tick();
  EXPECT_NE(rig.motor_Nm(), 0);
  rig.device().disconnect();
  for (const std::int64_t later_ns : {0, 2'000'000}) rig.drives().advance(rig.now_ns() + later_ns);
  EXPECT_FALSE(rig.drives().drive(0).enabled());
}

/// A drive that gives less than it was asked for says so, for the record.
TEST_P(CanSeam, ALimiterOfTheDriveIsSeen) {
  if (std::string(GetParam().driver) != "moteus") return;
  Emulation weak = usual();
  weak.moteus.max_torque_Nm = 0.004;  // half a newton at the axis
  CanRig rig(wall_on(GetParam()), weak);
  ASSERT_TRUE(rig.connect());
  ASSERT_TRUE(rig.enable()) << rig.fault_text();
  EXPECT_EQ(rig.sample().drive_limits, 0);
  ASSERT_TRUE(rig.run_until([&] { return rig.sample().drive_limits != 0; }, 1000));
  EXPECT_EQ(rig.mode(), Mode::enabled) << "no fault";
}

/// What is told of a sample is what it is: counts of the axis, when it came, how old it is.
TEST_P(CanSeam, ASampleIsNoOlderThanTheConfigWasCheckedFor) {
  CanRig rig(wall_on(GetParam()), usual());
  ASSERT_TRUE(rig.connect());
  ASSERT_TRUE(rig.enable());
  const double worst_s = rig.compiled().can[0]->worst_sample_age_s;
  EXPECT_GT(worst_s, 0);
  for (int i = 0; i < 500; ++i) {
    rig.tick();
    EXPECT_EQ(rig.sample().freshness, Freshness::fresh);
    EXPECT_LE(static_cast<double>(rig.sample().age_ns), 1e9 * worst_s);
  }
}

}  // namespace
}  // namespace hapticd::test
