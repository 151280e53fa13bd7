// What a device measures beside its positions: index pulse, homed flag, digital inputs, force.
#include <gtest/gtest.h>

#include <cmath>

#include "bench_device.h"

namespace hapticd::sim {
namespace {

/// 1 um a count; 1 mm/s, one count a tick, once it was pushed for one tick by 1 N.
DeviceOptions counting() {
  DeviceOptions options = free_mass();
  options.axes[0].counts_per_m = 1e6;
  options.axes[0].position_m = 0.01;
  return options;
}

/// Moves on at `velocity_m_s`, armed.
void coast(BenchDevice& bench, double velocity_m_s) {
  bench.command((velocity_m_s - bench.truth().velocity_m_s) * 1e3);
  bench.read();
  bench.command(0);
}

TEST(SimIndex, IsLatchedAtItsOwnCountOnceItIsPassed) {
  DeviceOptions options = counting();
  options.axes[0].index_m = 0.0100123;  // 12.3 counts on
  BenchDevice bench(options);
  bench.arm();
  coast(bench, 5e-3);
  while (bench.truth().position_m < 0.0100123) {
    ASSERT_FALSE(bench.samples[0].index);
    bench.read();
  }
  for (int n = 0; n < 20; ++n) {
    EXPECT_TRUE(bench.samples[0].index);
    EXPECT_EQ(bench.samples[0].index_raw, 10'012);
    bench.read();
  }
}

TEST(SimIndex, IsTheSameFromTheOtherSide) {
  DeviceOptions options = counting();
  options.axes[0].index_m = 0.0099876;
  BenchDevice bench(options);
  bench.arm();
  coast(bench, -5e-3);
  for (int n = 0; n < 20; ++n) bench.read();
  EXPECT_EQ(bench.samples[0].index_raw, 9987);
  coast(bench, 5e-3);
  for (int n = 0; n < 60; ++n) bench.read();
  EXPECT_GT(bench.truth().position_m, 0.01);
  EXPECT_EQ(bench.samples[0].index_raw, 9987);
}

TEST(SimIndex, IsNotSeenBeforeItIsPassedNorAfterAnotherConnect) {
  DeviceOptions options = counting();
  options.axes[0].index_m = 0.0101;
  BenchDevice bench(options);
  bench.arm();
  coast(bench, -5e-3);
  for (int n = 0; n < 50; ++n) EXPECT_FALSE(bench.read().index);
  coast(bench, 0.5);
  for (int n = 0; n < 50; ++n) bench.read();
  EXPECT_TRUE(bench.samples[0].index);
  bench.connect();
  EXPECT_FALSE(bench.read().index);
}

TEST(SimIndex, WrapsAndRunsBackwardsAsTheEncoderDoes) {
  DeviceOptions options = counting();
  options.axes[0].counts_per_m = -1e6;
  options.axes[0].encoder_bits = 8;
  options.axes[0].index_m = 0.0100123;
  BenchDevice bench(options);
  bench.arm();
  coast(bench, 5e-3);
  for (int n = 0; n < 20; ++n) bench.read();
  EXPECT_EQ(bench.samples[0].index_raw, -10'013 + 40 * 256);
}

TEST(SimEncoder, RelativeCountsFromWhereTheAxisStarts) {
  DeviceOptions options = counting();
  options.axes[0].relative = true;
  options.axes[0].index_m = 0.0100123;
  BenchDevice bench(options);
  bench.arm();
  EXPECT_EQ(bench.samples[0].raw, 0);
  coast(bench, 5e-3);
  for (int n = 0; n < 20; ++n) bench.read();
  EXPECT_EQ(bench.samples[0].raw, std::floor((bench.truth().position_m - 0.01) * 1e6));
  EXPECT_EQ(bench.samples[0].index_raw, 12);
}

TEST(SimEncoder, AbsoluteReadsNothingAtItsZero) {
  DeviceOptions options = counting();
  options.axes[0].zero_m = 0.009;
  BenchDevice bench(options);
  bench.read();
  EXPECT_EQ(bench.samples[0].raw, 1000);
}

TEST(SimDevice, SaysHomedFromItsTimeOn) {
  DeviceOptions options = counting();
  options.axes.push_back(options.axes[0]);
  options.axes[1].homed_at_s = 0.3;  // tick 300, although 0.3 / 0.001 is more
  BenchDevice bench(options);
  bench.tick = 1000;  // device time counts from the first tick
  for (int n = 0; n < 305; ++n) {
    bench.read();
    ASSERT_TRUE(bench.samples[0].homed);
    ASSERT_EQ(bench.samples[1].homed, n >= 300) << n;
  }
}

TEST(SimDevice, DigitalInputsFollowTheirScript) {
  DeviceOptions options = counting();
  options.digital = {{0.002, 1}, {0.005, 6}, {0.005, 3}, {0.007, 0}};
  BenchDevice bench(options);
  const std::uint32_t expected[] = {0, 0, 1, 1, 1, 3, 3, 0, 0};
  for (const std::uint32_t bits : expected) {
    bench.read();
    EXPECT_EQ(bench.aux.digital, bits) << "tick " << bench.tick;
  }
  bench.connect();
  bench.read();
  bench.read(3);
  EXPECT_EQ(bench.aux.digital, 1u) << "of the last tick, with others missed";
}

DeviceOptions pushed(double force_N) {
  DeviceOptions options = free_mass();
  options.force_sensor = ForceSensorOptions{};
  options.hand.script = {{.at_s = 0, .force_N = force_N}};
  return options;
}

TEST(SimForceSensor, AtRestMeasuresWhatTheHandPushes) {
  DeviceOptions options = pushed(5);
  options.axes[0].coulomb_N = 6;  // holds
  options.hand.mass_kg = 0.4;
  BenchDevice bench(options);
  bench.arm();
  EXPECT_EQ(bench.aux.analogue[0], 0) << "not yet";
  bench.read();
  EXPECT_EQ(bench.truth().position_m, 0);
  EXPECT_EQ(bench.aux.analogue[0], 5);
}

// 5 N on 1 kg and 0.25 kg of hand: 4 m/s^2, of which the hand's own mass takes 1 N.
TEST(SimForceSensor, LacksWhatAcceleratesTheHandsOwnMass) {
  DeviceOptions options = pushed(5);
  options.hand.mass_kg = 0.25;
  BenchDevice bench(options);
  bench.arm();
  for (int n = 0; n < 3; ++n) bench.read();
  EXPECT_NEAR(bench.aux.analogue[0], 5 - 0.25 * 4, 1e-13);
}

// The motor alone accelerates the hand's mass: it pulls back by m_h a.
TEST(SimForceSensor, FeelsTheHandsMassWhenTheMotorMovesIt) {
  DeviceOptions options = pushed(0);
  options.hand.mass_kg = 0.25;
  BenchDevice bench(options);
  bench.arm();
  bench.command(10);
  bench.read();
  EXPECT_NEAR(bench.aux.analogue[0], -0.25 * 10 / 1.25, 1e-13);
}

// Sliding against friction: what is left of it is m a of the device alone, by Newton.
TEST(SimForceSensor, IsWhatTheDevicesOwnMotionNeeds) {
  DeviceOptions options = pushed(5);
  options.axes[0].damping_Ns_m = 3;
  options.axes[0].coulomb_N = 0.5;
  options.hand.mass_kg = 0.25;
  options.hand.stiffness_N_m = 80;
  options.hand.damping_Ns_m = 2;
  options.substeps = 100;
  BenchDevice bench(options);
  bench.arm();
  bench.command(-1);
  for (int n = 0; n < 20; ++n) bench.read();
  const Truth before = bench.truth();
  const double force_N = bench.aux.analogue[0];
  bench.read();
  const double acceleration = (bench.truth().velocity_m_s - before.velocity_m_s) / 1e-3;
  const double velocity = (bench.truth().velocity_m_s + before.velocity_m_s) / 2;
  const double middle_N = (force_N + bench.aux.analogue[0]) / 2;
  EXPECT_GT(velocity, 0.01);
  EXPECT_NEAR(middle_N, 1 * acceleration + 3 * velocity + 0.5 + 1, 1e-5);
}

TEST(SimForceSensor, HasNoiseOfItsStandardDeviationOnEveryAxis) {
  DeviceOptions options = pushed(0);
  options.axes.push_back(options.axes[0]);
  options.force_sensor->noise_N = 0.1;
  BenchDevice bench(options);
  double squares[2] = {}, product = 0;
  for (int n = 0; n < 4000; ++n) {
    bench.read();
    for (std::size_t i = 0; i < 2; ++i) squares[i] += std::pow(bench.aux.analogue[i], 2);
    product += bench.aux.analogue[0] * bench.aux.analogue[1];
  }
  for (const double sum : squares) EXPECT_NEAR(std::sqrt(sum / 4000), 0.1, 0.005);
  EXPECT_NEAR(product / 4000, 0, 0.0008) << "the same noise on both";
  EXPECT_EQ(bench.aux.analogue[2], 0);
}

TEST(SimForceSensor, WithoutOneTheAnalogueInputsStayZero) {
  DeviceOptions options = pushed(5);
  options.force_sensor.reset();
  BenchDevice bench(options);
  bench.arm();
  bench.read();
  EXPECT_EQ(bench.aux.analogue[0], 0);
}

}  // namespace
}  // namespace hapticd::sim
