// Motors and mechanics together.
#include "sim/emulated_device.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/unit/emulators/host_end.h"

namespace hapticd::test::emulator {
namespace {

using namespace sim::can;
using sim::EmulatedDevice, sim::turning;

sim::DeviceOptions free_mass(double mass_kg, double at_m = 0) {
  sim::DeviceOptions options;
  options.name = "mass";
  sim::AxisOptions axis;
  axis.mass_kg = mass_kg;
  axis.position_m = at_m;
  axis.max_effort_N = 1000;
  axis.counts_per_m = -3;
  axis.noise_counts = 5;
  axis.delay_s = 0.01;
  options.axes = {axis};
  return options;
}

TEST(EmulatedDevice, TellsTheDrivesWhereTheirMotorsAre) {
  EchoDrive drive(1);
  EmulatedDevice device(free_mass(1, 0.5), {turning(drive, -4, 0.25)});
  ASSERT_TRUE(device.start());
  device.advance(123);
  EXPECT_DOUBLE_EQ(device.position(0), 0.5);
  EXPECT_DOUBLE_EQ(drive.turns, -1.75);
  EXPECT_EQ(drive.turns_s, 0);
}

TEST(EmulatedDevice, TorqueBecomesForceThroughTheTransmission) {
  EchoDrive drive(1);
  drive.on = true;
  drive.torque = 0.2;
  const double turns_per_m = -25;
  EmulatedDevice device(free_mass(2), {turning(drive, turns_per_m)});
  ASSERT_TRUE(device.start());
  device.advance(0);
  for (int i = 1; i <= 100; ++i) device.advance(i * kMs);
  const double force_N = 0.2 * 2 * std::numbers::pi * turns_per_m;
  EXPECT_NEAR(device.position(0), 0.5 * force_N / 2 * 0.01, 1e-12);
  EXPECT_NEAR(drive.turns, turns_per_m * device.position(0), 1e-12);
  EXPECT_NEAR(drive.turns_s, turns_per_m * force_N / 2 * 0.1, 1e-9);
  // Power of the motor is power into the mass.
  EXPECT_NEAR(0.2 * 2 * std::numbers::pi * drive.turns, device.truth().truth(0).effort_work_J,
              1e-9);
}

TEST(EmulatedDevice, BetweenStepsItGoesOnWithItsVelocity) {
  EchoDrive drive(1);
  drive.on = true;
  drive.torque = 1;
  EmulatedDevice device(free_mass(1), {turning(drive, 1)}, 1e-3);
  ASSERT_TRUE(device.start());
  device.advance(0);
  device.advance(10 * kMs);
  drive.torque = 0;
  const double at_m = device.position(0);
  device.advance(10 * kMs + 300 * kUs);
  EXPECT_NEAR(device.position(0), at_m + 300e-6 * drive.turns_s, 1e-15);
  device.advance(11 * kMs);
  EXPECT_NEAR(device.position(0), at_m + 1e-3 * drive.turns_s, 1e-12);
}

TEST(EmulatedDevice, ADisabledDriveMakesNoForce) {
  EchoDrive drive(1);
  drive.torque = 1;
  EmulatedDevice device(free_mass(1), {turning(drive)});
  ASSERT_TRUE(device.start());
  device.advance(0);
  device.advance(100 * kMs);
  EXPECT_EQ(device.position(0), 0);
}

TEST(EmulatedDevice, TheHandsScriptStartsWithTheFirstDrive) {
  sim::DeviceOptions options = free_mass(1);
  options.hand.script = {{.at_s = 0, .force_N = 3, .position_m = 0}};
  options.ramp_s = 0.01;
  EchoDrive drive(1);
  EmulatedDevice device(options, {turning(drive)});
  ASSERT_TRUE(device.start());
  device.advance(0);
  device.advance(100 * kMs);
  EXPECT_EQ(device.position(0), 0);
  drive.on = true;
  device.advance(110 * kMs);
  EXPECT_EQ(device.position(0), 0);
  device.advance(120 * kMs);
  EXPECT_NEAR(device.position(0), 0.5 * 3 * 1e-4, 1e-9);
}

TEST(EmulatedDevice, MotorsMustFitTheAxes) {
  EmulatedDevice device(free_mass(1), {});
  const auto started = device.start();
  ASSERT_FALSE(started);
  EXPECT_NE(started.error().text.find("1 axes, found 0"), std::string::npos);
  EchoDrive drive(1);
  EXPECT_FALSE(EmulatedDevice(free_mass(-1), {turning(drive)}).start());
}

}  // namespace
}  // namespace hapticd::test::emulator
