// A linkage behind the device interface.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "bench_device.h"
#include "five_bar.h"
#include "tests/support/heap_guard.h"

namespace hapticd::sim {
namespace {

/// One joint along +x of the device: a free mass of 1 kg behind a tip.
DeviceOptions rail() {
  DeviceOptions options = free_mass();
  options.axes[0].mass_kg = 0.75;
  control::LinearMap map;
  map.columns[0][0] = 1;
  options.linkage = LinkageOptions{.geometry = map, .tip_kg = 0.25};
  return options;
}

DeviceOptions everything() {
  DeviceOptions options = five_bar();
  options.axes[0].delay_s = 0.00037;
  options.axes[1].delay_s = 0.00214;
  for (AxisOptions& axis : options.axes) {
    axis.coulomb_N = 1e-3;
    axis.damping_Ns_m = 8e-4;
    axis.noise_counts = 2;
    axis.counts_per_m = 1e5;
    axis.stops = StopOptions{axis.position_m - 0.2, axis.position_m + 0.2};
    axis.index_m = axis.position_m + 0.05;
  }
  options.force_sensor = ForceSensorOptions{.noise_N = 0.01};
  options.linkage->gravity = {0, 0, -9.81};
  options.hand = {.mass_kg = 0.1,
                  .stiffness_N_m = 100,
                  .damping_Ns_m = 1,
                  .script = {{.at_s = 0.02, .force_N = 1}, {.at_s = 0.06, .position_m = 0.02}}};
  return options;
}

class LinkageDelay : public ::testing::TestWithParam<double> {};

TEST_P(LinkageDelay, ForceComesExactlyThatMuchLater) {
  DeviceOptions options = rail();
  options.axes[0].delay_s = GetParam();
  BenchDevice bench(options);
  bench.arm();
  bench.command(1);
  for (int n = 1; n <= 6; ++n) {
    bench.read();
    const double acted_s = std::max(0.0, n * 1e-3 - GetParam());
    EXPECT_NEAR(bench.truth().velocity_m_s, acted_s, 1e-14) << "period " << n;
    EXPECT_NEAR(bench.truth().position_m, 0.5 * acted_s * acted_s, 1e-16) << "period " << n;
    EXPECT_NEAR(bench.truth().effort_work_J, 0.5 * acted_s * acted_s, 1e-16);
  }
}

INSTANTIATE_TEST_SUITE_P(FractionsAndWholePeriods, LinkageDelay,
                         ::testing::Values(0.0, 0.0001, 0.00025, 0.000837, 0.001, 0.0013,
                                           0.003456));

TEST(LinkageDevice, EveryJointHasADelayOfItsOwn) {
  DeviceOptions options = rail();
  options.axes.push_back(options.axes[0]);
  options.axes[0].delay_s = 0.00037;
  options.axes[1].delay_s = 0.00214;
  std::get<control::LinearMap>(options.linkage->geometry).columns[1][1] = 1;
  BenchDevice bench(options);
  bench.arm();
  bench.command(1);
  for (int n = 0; n < 5; ++n) bench.read();
  EXPECT_NEAR(bench.truth(0).velocity_m_s, 0.005 - 0.00037, 1e-14);
  EXPECT_NEAR(bench.truth(1).velocity_m_s, 0.005 - 0.00214, 1e-14);
  EXPECT_NEAR(bench.device.tip().position_m[1], 0.5 * 0.00286 * 0.00286, 1e-16);
}

// On the rail both must be the same machine.
TEST(LinkageDevice, OnARailMovesLikeAnAxisOnItsOwn) {
  DeviceOptions axis = free_mass(), joint = rail();
  for (DeviceOptions* options : {&axis, &joint}) {
    options->axes[0].damping_Ns_m = 3;
    options->axes[0].delay_s = 0.0004;
    options->force_sensor = ForceSensorOptions{};
    options->hand = {.mass_kg = 0.5,
                     .stiffness_N_m = 300,
                     .damping_Ns_m = 4,
                     .script = {{.at_s = 0, .force_N = 2}, {.at_s = 0.1, .position_m = 0.02}}};
  }
  BenchDevice one(axis), other(joint);
  one.arm();
  other.arm();
  for (int n = 0; n < 200; ++n) {
    one.command(std::sin(0.2 * n));
    other.command(std::sin(0.2 * n));
    one.read();
    other.read();
    ASSERT_NEAR(other.truth().position_m, one.truth().position_m, 1e-11) << n;
    ASSERT_NEAR(other.truth().velocity_m_s, one.truth().velocity_m_s, 1e-9) << n;
    ASSERT_NEAR(other.truth().effort_work_J, one.truth().effort_work_J, 1e-10) << n;
    ASSERT_NEAR(other.aux.analogue[0], one.aux.analogue[0], 1e-8) << n;
  }
  EXPECT_GT(one.truth().max_position_m, 0.01);
  EXPECT_NEAR(other.device.tip().energy_J, one.truth().energy_J, 1e-9);
}

TEST(LinkageDevice, TruthBalancesItsEnergyWithEverythingOn) {
  DeviceOptions options = everything();
  for (AxisOptions& axis : options.axes) axis.stops.reset();
  BenchDevice bench(options);
  const double start_J = bench.device.tip().energy_J;
  bench.arm();
  for (int n = 0; n < 300; ++n) {
    bench.efforts = {0.05 * std::sin(0.05 * n), 0.03 * std::cos(0.07 * n), 0, 0};
    bench.device.command(std::span(bench.efforts).first(2), std::span(bench.delivered).first(2));
    bench.read();
    const TipTruth& tip = bench.device.tip();
    const double work_J = bench.truth(0).effort_work_J + bench.truth(1).effort_work_J;
    ASSERT_NEAR(tip.energy_J - start_J, work_J + tip.hand_work_J - tip.lost_J, 1e-10) << n;
  }
  EXPECT_GT(bench.device.tip().lost_J, 1e-3);
}

// What an energy ledger on the encoders of a device without delay must find: effort times the way
// from sample to sample.
TEST(LinkageDevice, WorkOfAJointIsItsEffortTimesItsWay) {
  BenchDevice bench(five_bar());
  bench.arm();
  double work_J = 0, before = bench.truth(1).position_m;
  for (int n = 0; n < 20; ++n) {
    const double effort = 0.01 * (1 + std::cos(0.5 * n));
    bench.command(effort);
    bench.read();
    work_J += effort * (bench.truth(1).position_m - before);
    before = bench.truth(1).position_m;
  }
  EXPECT_GT(std::abs(work_J), 1e-5);
  EXPECT_NEAR(bench.truth(1).effort_work_J, work_J, 1e-15);
}

TEST(LinkageDevice, EncodersAndTipShowTheSameMotion) {
  BenchDevice bench(five_bar());
  bench.arm();
  EXPECT_NEAR(bench.device.tip().position_m[1], 0.25, 1e-12);
  bench.command(0.005);
  for (int n = 0; n < 30; ++n) bench.read();
  const control::FiveBar bars{.linkage = 0, .link_m = 0.2, .base_m = 0.1};
  const double q[] = {bench.samples[0].raw * 1e-9, bench.samples[1].raw * 1e-9};
  control::LinkagePose pose;
  ASSERT_TRUE(pose_of(bars, q, pose));
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(pose.tip[i], bench.device.tip().position_m[i], 1e-9);
    const double velocity = pose.jacobian[i][0] * bench.truth(0).velocity_m_s +
                            pose.jacobian[i][1] * bench.truth(1).velocity_m_s;
    EXPECT_NEAR(velocity, bench.device.tip().velocity_m_s[i], 1e-8);
  }
  EXPECT_GT(std::abs(bench.device.tip().velocity_m_s[0]), 0.01);
  EXPECT_EQ(bench.device.trace(0).back(), bench.truth(0).position_m);
}

TEST(LinkageDevice, ForceSensorIsInTheDevicesFrame) {
  DeviceOptions options = everything();
  for (AxisOptions& axis : options.axes) axis.coulomb_N = 1;  // holds
  options.linkage->gravity = {};
  options.linkage->hand_direction = {0.6, -0.8, 0};
  options.force_sensor->noise_N = 0;
  BenchDevice bench(options);
  bench.arm();
  for (int n = 0; n < 25; ++n) bench.read();
  // The script's 1 N, and 100 N/m of a rest that is 1/8 of the way to 20 mm.
  const double force_N = 1 + 100 * 0.02 * static_cast<double>(bench.tick - 20) / 40;
  EXPECT_NEAR(bench.aux.analogue[0], 0.6 * force_N, 1e-12);
  EXPECT_NEAR(bench.aux.analogue[1], -0.8 * force_N, 1e-12);
  EXPECT_EQ(bench.aux.analogue[2], 0);
}

std::vector<double> readings(BenchDevice& bench) {
  std::vector<double> result;
  bench.device.set_armed(true);
  for (int n = 0; n < 200; ++n) {
    bench.read();
    bench.command(0.01 * (n % 7));
    for (const double value : {bench.samples[0].raw, bench.samples[1].raw, bench.aux.analogue[0],
                               bench.device.tip().energy_J})
      result.push_back(value);
  }
  return result;
}

TEST(LinkageDevice, TwoConnectsGiveTheSameRun) {
  BenchDevice bench(everything());
  const std::vector<double> first = readings(bench);
  bench.connect();
  EXPECT_EQ(bench.device.tip().lost_J, 0);
  EXPECT_EQ(readings(bench), first);
  DeviceOptions other = everything();
  other.seed = 2;
  BenchDevice noisy(other);
  EXPECT_NE(readings(noisy), first);
}

TEST(LinkageDevice, NeverCallsTheHeapInTheLoop) {
  if (!test::HeapGuard::available())
    GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  BenchDevice bench(everything());
  const test::HeapGuard guard;
  for (int n = 0; n < 200; ++n) {
    bench.device.set_armed(n > 20);
    bench.read(n % 50 == 0 ? 3 : 0);
    bench.command(0.1);
    if (n == 150) bench.device.stop();
  }
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace hapticd::sim
