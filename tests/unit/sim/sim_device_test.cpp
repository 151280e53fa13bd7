#include "sim/sim_device.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench_device.h"
#include "tests/support/heap_guard.h"

namespace hapticd::sim {
namespace {

TEST(SimDevice, SamplesInPhaseWithoutAge) {
  SimDevice device(free_mass());
  const auto info = device.connect();
  ASSERT_TRUE(info.has_value());
  EXPECT_EQ(info->timing, drivers::Timing::in_phase);
  EXPECT_EQ(info->worst_sample_age_s, 0);
  EXPECT_TRUE(device.lock_names().empty()) << "there is nothing physical to lock";
  BenchDevice bench(free_mass());
  bench.read();
  const AxisSample& sample = bench.read();
  EXPECT_EQ(sample.freshness, Freshness::fresh);
  EXPECT_EQ(sample.stamp_ns, 1'000'000);
  EXPECT_EQ(sample.age_ns, 0);
}

TEST(SimDevice, EffortActsFromItsTickToTheNextCommand) {
  BenchDevice bench(free_mass());
  bench.arm();
  bench.command(2);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 2e-3, 1e-15);
  EXPECT_NEAR(bench.truth().position_m, 1e-6, 1e-18);
  bench.read();  // nothing commanded: held
  EXPECT_NEAR(bench.truth().velocity_m_s, 4e-3, 1e-15);
  bench.command(0);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 4e-3, 1e-15);
}

TEST(SimDevice, MissedTicksHoldTheLastEffort) {
  BenchDevice bench(free_mass());
  bench.arm();
  bench.command(2);
  bench.read(4);
  EXPECT_NEAR(bench.truth().velocity_m_s, 10e-3, 1e-15);
  EXPECT_NEAR(bench.truth().position_m, 0.5 * 2 * 25e-6, 1e-17);
}

TEST(SimDevice, ALongGapIsMadeUpForByOneSecondOnly) {
  BenchDevice bench(free_mass());
  bench.arm();
  bench.command(1);
  bench.read(1'000'000'000);
  EXPECT_NEAR(bench.truth().velocity_m_s, 1, 1e-9);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 1.001, 1e-9);
}

TEST(SimDevice, EffortsOnlyActWhileArmed) {
  BenchDevice bench(free_mass());
  bench.read();
  EXPECT_FALSE(bench.aux.armed);
  EXPECT_EQ(bench.command(5), 0) << "nothing is carried";
  bench.device.set_armed(true);
  bench.read();
  EXPECT_TRUE(bench.aux.armed);
  EXPECT_EQ(bench.truth().velocity_m_s, 0);
  EXPECT_EQ(bench.command(5), 5);
  bench.device.set_armed(false);
  bench.read();
  EXPECT_FALSE(bench.aux.armed);
  EXPECT_NEAR(bench.truth().velocity_m_s, 5e-3, 1e-15) << "armed until the collect of this tick";
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 5e-3, 1e-15);
}

TEST(SimDevice, StopTakesTheEffortAway) {
  BenchDevice bench(free_mass());
  bench.arm();
  bench.command(5);
  bench.device.stop();
  bench.read();
  EXPECT_EQ(bench.truth().velocity_m_s, 0);
  EXPECT_TRUE(bench.aux.armed);
}

TEST(SimDevice, DeliveredIsWhatTheAmplifierCarries) {
  DeviceOptions options = free_mass();
  options.axes[0].dac_step_N = 0.25;
  options.axes[0].max_effort_N = 3;
  BenchDevice bench(options);
  bench.arm();
  EXPECT_EQ(bench.command(1.1), 1.0);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 1e-3, 1e-15);
  EXPECT_EQ(bench.command(-50), -3);
}

class Delay : public ::testing::TestWithParam<double> {};

// After n periods of 1 N, commanded from the first on, the force has acted for n T - delay.
TEST_P(Delay, ForceComesExactlyThatMuchLater) {
  DeviceOptions options = free_mass();
  options.axes[0].delay_s = GetParam();
  BenchDevice bench(options);
  bench.arm();
  bench.command(1);
  for (int n = 1; n <= 6; ++n) {
    bench.read();
    const double acted_s = std::max(0.0, n * 1e-3 - GetParam());
    EXPECT_NEAR(bench.truth().velocity_m_s, acted_s, 1e-14) << "period " << n;
    EXPECT_NEAR(bench.truth().position_m, 0.5 * acted_s * acted_s, 1e-16) << "period " << n;
  }
}

TEST_P(Delay, AnImpulseIsOnePeriodLongWhereverItFalls) {
  DeviceOptions options = free_mass();
  options.axes[0].delay_s = GetParam();
  BenchDevice bench(options);
  bench.arm();
  bench.command(1);
  bench.read();
  bench.command(0);
  for (int n = 0; n < 6; ++n) bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 1e-3, 1e-14);
  EXPECT_NEAR(bench.truth().position_m, 1e-3 * (7e-3 - GetParam() - 0.5e-3), 1e-16);
}

INSTANTIATE_TEST_SUITE_P(FractionsAndWholePeriods, Delay,
                         ::testing::Values(0.0, 1e-7, 0.0001, 0.00025, 0.0005, 0.000837,
                                           0.0009999999, 0.001, 0.0013, 0.002, 0.003456));

TEST(SimDevice, PowerOffTakesAwayWhatIsStillOnItsWay) {
  DeviceOptions options = free_mass();
  options.axes[0].delay_s = 0.0025;
  BenchDevice bench(options);
  bench.arm();
  bench.command(1);
  bench.device.set_armed(false);
  for (int n = 0; n < 10; ++n) bench.read();
  EXPECT_EQ(bench.truth().velocity_m_s, 0);
}

TEST(SimDevice, ScriptStartsItsRampAfterArming) {
  DeviceOptions options = free_mass();
  options.ramp_s = 0.01;
  options.hand.script = {{.at_s = 0.005, .force_N = 1}};
  BenchDevice bench(options);
  for (int n = 0; n < 100; ++n) bench.read();
  bench.arm();
  for (int n = 0; n < 15; ++n) bench.read();
  EXPECT_EQ(bench.truth().velocity_m_s, 0);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 1e-3, 1e-15);
  EXPECT_NEAR(bench.truth().script_work_J, 0.5e-6, 1e-18);
}

TEST(SimDevice, HandLetsGoWithThePowerAndStartsAnewWithIt) {
  DeviceOptions options = free_mass();
  options.hand.script = {{.at_s = 0, .force_N = 1}, {.at_s = 0.002, .force_N = 0}};
  BenchDevice bench(options);
  bench.arm();
  for (int n = 0; n < 10; ++n) bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 2e-3, 1e-15);
  bench.device.set_armed(false);
  for (int n = 0; n < 10; ++n) bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 2e-3, 1e-15);
  bench.arm();
  for (int n = 0; n < 10; ++n) bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 4e-3, 1e-15);
}

TEST(SimDevice, HandMassMovesWithTheAxis) {
  DeviceOptions options = free_mass();
  options.hand.mass_kg = 3;
  BenchDevice bench(options);
  bench.arm();
  bench.command(4);
  bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, 1e-3, 1e-15);
}

TEST(SimDevice, TruthBalancesItsEnergy) {
  DeviceOptions options = free_mass();
  options.hand.stiffness_N_m = 200;
  options.hand.script = {{.at_s = 0, .force_N = 0.7}};
  BenchDevice bench(options);
  bench.arm();
  for (int n = 0; n < 200; ++n) {
    bench.command(std::sin(0.1 * n));
    bench.read();
  }
  const Truth& truth = bench.truth();
  EXPECT_GT(truth.energy_J, 1e-3);
  EXPECT_NEAR(truth.energy_J, truth.effort_work_J + truth.script_work_J,
              1e-12 * truth.energy_J + 1e-15);
}

TEST(SimDevice, ExtremesAreSeenBetweenTicks) {
  DeviceOptions options = free_mass();
  options.hand.stiffness_N_m = 4e6;  // swings in 3.1 ms
  options.hand.script = {{.at_s = 0, .force_N = 0, .position_m = 0.01}};
  BenchDevice bench(options);
  bench.arm();
  double largest_m = 0;
  for (int n = 0; n < 3; ++n) {
    bench.read();
    largest_m = std::max(largest_m, bench.truth().position_m);
    ASSERT_EQ(bench.device.trace(0).size(), 10u);
    EXPECT_EQ(bench.device.trace(0).back(), bench.truth().position_m);
  }
  EXPECT_NEAR(bench.truth().max_position_m, 0.02, 5e-5);
  EXPECT_LT(largest_m, 0.0199);
}

std::vector<double> readings(BenchDevice& bench, std::size_t axis) {
  std::vector<double> result;
  bench.device.set_armed(true);
  for (int n = 0; n < 200; ++n) {
    bench.read();
    bench.command(0.01 * (n % 7));
    result.push_back(bench.samples[axis].raw);
  }
  return result;
}

DeviceOptions noisy(std::uint64_t seed) {
  DeviceOptions options = free_mass();
  options.axes[0].noise_counts = 3;
  options.axes[0].counts_per_m = 1e6;
  options.axes.push_back(options.axes[0]);
  options.seed = seed;
  options.hand.script = {{.at_s = 0.05, .force_N = 1}, {.at_s = 0.1, .force_N = -1}};
  return options;
}

TEST(SimDevice, TwoConnectsGiveTheSameRun) {
  BenchDevice bench(noisy(1));
  const std::vector<double> first = readings(bench, 0);
  bench.connect();
  EXPECT_EQ(bench.truth().max_position_m, 0);
  EXPECT_EQ(readings(bench, 0), first);
}

TEST(SimDevice, ARunDoesNotDependOnTheNumberOfItsFirstTick) {
  BenchDevice early(noisy(1)), late(noisy(1));
  late.tick = 123'456'789;
  EXPECT_EQ(readings(early, 0), readings(late, 0));
}

TEST(SimDevice, SeedsAndAxesHaveNoiseOfTheirOwn) {
  BenchDevice one(noisy(1)), same(noisy(1)), other(noisy(2)), second_axis(noisy(1));
  const std::vector<double> expected = readings(one, 0);
  EXPECT_EQ(readings(same, 0), expected);
  EXPECT_NE(readings(other, 0), expected);
  EXPECT_NE(readings(second_axis, 1), expected);
}

TEST(SimDevice, NeverCallsTheHeapInTheLoop) {
  if (!test::HeapGuard::available())
    GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  DeviceOptions options = noisy(1);
  options.axes[0].delay_s = 0.00314;
  options.axes[0].coulomb_N = 0.1;
  options.failures = {{.kind = FailureKind::stuck, .at_s = 0.01, .for_s = 0.01},
                      {.kind = FailureKind::disarm, .at_s = 0.05, .for_s = 0.01},
                      {.kind = FailureKind::slow, .at_s = 0.02, .for_s = 1e-4}};
  BenchDevice bench(options);
  const test::HeapGuard guard;
  for (int n = 0; n < 200; ++n) {
    bench.device.set_armed(n > 20);
    bench.read(n % 50 == 0 ? 3 : 0);
    bench.command(1);
    if (n == 150) bench.device.stop();
  }
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace hapticd::sim
