// A hand across devices against closed forms (modes of masses and springs), against the hand that
// every axis has of its own, and what the devices that share it owe to each other.
#include "sim/shared_hand.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared_bench.h"
#include "tests/support/heap_guard.h"
#include "tests/support/held_mass.h"

namespace hapticd::sim {
namespace {

constexpr double kSharedRelative = 1e-12;
constexpr double kPeriod_s = 1e-3;

/// Two axes, each with a spring and a damper to ground.
SharedHandOptions springs_to_ground(double stiffness_N_m, double damping_Ns_m) {
  const double k = stiffness_N_m, d = damping_Ns_m;
  return {.axes = {{.device = 0}, {.device = 1}},
          .states = 2,
          .A = {0, 0, 0, 0},
          .B = {1, 0, 0, 1},
          .C = {k, 0, 0, k},
          .D = {d, 0, 0, d}};
}

// A mass of its own would make F improper: it is on the axes here, in the hand there.
TEST(SharedHand, MassSpringDamperAsAStateSpaceEqualsTheHandOfEachAxis) {
  constexpr double kHand_kg = 0.3, kStiffness_N_m = 700, kDamping_Ns_m = 2.5;
  constexpr double kDelays_s[] = {0.3e-3, 1.7e-3};
  std::vector<DeviceOptions> own, held;
  for (std::size_t i = 0; i < 2; ++i) {
    const double mass_kg = i == 0 ? 0.1 : 0.4;
    held.push_back(one_axis("held", mass_kg + kHand_kg, kDelays_s[i]));
    own.push_back(one_axis("own", mass_kg, kDelays_s[i]));
    own[i].hand = {.mass_kg = kHand_kg,
                   .stiffness_N_m = kStiffness_N_m,
                   .damping_Ns_m = kDamping_Ns_m,
                   .script = {}};
  }
  SharedBench apart(own), together(springs_to_ground(kStiffness_N_m, kDamping_Ns_m), held);
  double most_m = 0;
  for (int i = 0; i < 1000; ++i) {
    run(apart, 1);
    run(together, 1);
    for (std::size_t device = 0; device < 2; ++device) {
      const Truth &a = apart.truth(device), &b = together.truth(device);
      most_m = std::max(most_m, std::abs(a.position_m));
      ASSERT_NEAR(b.position_m, a.position_m, kSharedRelative * most_m) << "tick " << i;
      ASSERT_NEAR(b.velocity_m_s, a.velocity_m_s, kSharedRelative * 50 * most_m) << "tick " << i;
      const double spring_J = 0.5 * kStiffness_N_m * b.position_m * b.position_m;
      ASSERT_NEAR(b.energy_J + spring_J, a.energy_J,
                  kSharedRelative * kStiffness_N_m * most_m * most_m);
      ASSERT_NEAR(b.effort_work_J, a.effort_work_J, 1e-12);
    }
  }
  EXPECT_GT(most_m, 1e-4) << "nothing moved";
}

// A spring between two masses: the centre of mass goes on, the distance r swings,
//   r = v0 / w sin w t,  w^2 = k (1/m1 + 1/m2)
TEST(SharedHand, SpringBetweenTwoDevicesSwingsAsTheClosedFormDoes) {
  constexpr double kStiffness_N_m = 900, kMass_kg = 0.2, kOther_kg = 0.5, kVelocity_m_s = 0.3;
  const SharedHandOptions hand{
      .axes = {{.device = 0, .velocity_m_s = kVelocity_m_s}, {.device = 1}},
      .states = 1,
      .A = {0},
      .B = {1, -1},
      .C = {kStiffness_N_m, -kStiffness_N_m},
      .D = {0, 0, 0, 0}};
  SharedBench bench(hand, {one_axis("left", kMass_kg), one_axis("right", kOther_kg)});
  const double total_kg = kMass_kg + kOther_kg;
  const double w = std::sqrt(kStiffness_N_m * (1 / kMass_kg + 1 / kOther_kg));
  EXPECT_EQ(bench.truth(0).velocity_m_s, kVelocity_m_s);
  for (int i = 1; i <= 300; ++i) {
    bench.read();
    const double t = i * kPeriod_s, r = kVelocity_m_s / w * std::sin(w * t);
    const double centre_m = kMass_kg / total_kg * kVelocity_m_s * t;
    EXPECT_NEAR(bench.truth(0).position_m, centre_m + kOther_kg / total_kg * r,
                kSharedRelative * 0.1);
    EXPECT_NEAR(bench.truth(1).position_m, centre_m - kMass_kg / total_kg * r,
                kSharedRelative * 0.1);
    const double kinetic_J =
        0.5 * total_kg * std::pow(centre_m / t, 2) +
        0.5 * kMass_kg * kOther_kg / total_kg * std::pow(kVelocity_m_s * std::cos(w * t), 2);
    EXPECT_NEAR(bench.truth(0).energy_J + bench.truth(1).energy_J, kinetic_J, kSharedRelative);
  }
}

// A hand with a mass of its own behind a spring: states (stretch, velocity of the hand).
//   v = vc + v0 mh / (m + mh) cos w t,  vc = v0 m / (m + mh),  w^2 = k (1/m + 1/mh)
TEST(SharedHand, HandWithAMassOfItsOwnTakesAndReturnsMomentum) {
  constexpr double k = 400, m = 0.2, mh = 0.6, v0 = 0.1;
  const SharedHandOptions hand{.axes = {{.velocity_m_s = v0}},
                               .states = 2,
                               .A = {0, -1, k / mh, 0},
                               .B = {1, 0},
                               .C = {k, 0},
                               .D = {0}};
  SharedBench bench(hand, {one_axis("axis", m)});
  const double w = std::sqrt(k * (1 / m + 1 / mh));
  for (int i = 1; i <= 300; ++i) {
    bench.read();
    const double swing_m_s = v0 * mh / (m + mh) * std::cos(w * i * kPeriod_s);
    EXPECT_NEAR(bench.truth(0).velocity_m_s, v0 * m / (m + mh) + swing_m_s, kSharedRelative * v0);
  }
}

// D = [d e; e d] on equal masses: sum and difference of the axes are masses with dampers d + e and
// d - e. The efforts arrive after 0.25 and 0.6 periods: three pieces, each with its own force.
TEST(SharedHand, DelaysOfEachDeviceAreExactWhileAHandCouplesThem) {
  constexpr double kMass_kg = 0.02, d = 3, e = 2, kLeft_N = 1, kRight_N = 2;
  const SharedHandOptions hand{.axes = {{.device = 0}, {.device = 1}},
                               .states = 0,
                               .A = {},
                               .B = {},
                               .C = {},
                               .D = {d, e, e, d}};
  SharedBench bench(hand, {one_axis("left", kMass_kg, 0.25 * kPeriod_s),
                           one_axis("right", kMass_kg, 0.6 * kPeriod_s)});
  bench.command(0, kLeft_N);
  bench.command(1, kRight_N);
  bench.read();
  test::HeldMass sum{kMass_kg, d + e}, difference{kMass_kg, d - e};
  for (test::HeldMass* mode : {&sum, &difference}) {
    mode->advance(kLeft_N, 0.35 * kPeriod_s);
    mode->advance(kLeft_N + (mode == &sum ? kRight_N : -kRight_N), 0.4 * kPeriod_s);
  }
  const double left_m = 0.5 * (sum.x + difference.x), right_m = 0.5 * (sum.x - difference.x);
  EXPECT_NEAR(bench.truth(0).position_m, left_m, kSharedRelative * left_m);
  EXPECT_NEAR(bench.truth(1).position_m, right_m, kSharedRelative * left_m);
  EXPECT_NEAR(bench.truth(1).velocity_m_s, 0.5 * (sum.v - difference.v), kSharedRelative * sum.v);
}

// The left device coasts; the right one feels its velocity and its way, and nothing comes back.
TEST(SharedHand, MatricesGoByTheOrderOfTheAxesThatItNames) {
  constexpr double kMass_kg = 0.3, kVelocity_m_s = 0.2, k = 50, d = 6;
  const SharedHandOptions hand{
      .axes = {{.device = 1}, {.device = 0, .velocity_m_s = kVelocity_m_s}},
      .states = 1,
      .A = {0},
      .B = {0, 1},
      .C = {k, 0},
      .D = {0, d, 0, 0}};
  SharedBench bench(hand, {one_axis("left", 0.1), one_axis("right", kMass_kg)});
  for (int i = 0; i < 100; ++i) bench.read();
  const double t = 100 * kPeriod_s, way_m = kVelocity_m_s * t;
  const double momentum = -d * way_m - 0.5 * k * way_m * t;
  EXPECT_EQ(bench.truth(0).velocity_m_s, kVelocity_m_s);
  EXPECT_NEAR(bench.truth(1).velocity_m_s, momentum / kMass_kg, kSharedRelative);
}

TEST(SharedHand, AxesThatItDoesNotNameMoveBesideIt) {
  DeviceOptions device = one_axis("device", 1);
  device.axes.push_back(device.axes[0]);
  const SharedHandOptions hand{
      .axes = {{.axis = 1}}, .states = 1, .A = {0}, .B = {1}, .C = {1e4}, .D = {0}};
  SharedBench bench(hand, {device});
  bench.command(0, 1);
  for (int i = 0; i < 100; ++i) bench.read();
  EXPECT_NEAR(bench.truth(0, 0).position_m, 0.5 * 0.1 * 0.1, kSharedRelative * 5e-3);
  EXPECT_NEAR(bench.truth(0, 1).position_m, 1e-4 * (1 - std::cos(100 * 0.1)),
              kSharedRelative * 5e-3);
}

TEST(SharedHand, ForceSensorShowsWhatTheHandDoesToItsAxis) {
  constexpr double k = 700, d = 2.5;
  std::vector<DeviceOptions> devices{one_axis("left", 0.2), one_axis("right", 0.3)};
  devices[1].force_sensor.emplace();
  SharedBench bench(springs_to_ground(k, d), devices);
  run(bench, 20);
  const Truth& right = bench.truth(1);
  const double force_N = -k * right.position_m - d * right.velocity_m_s;
  EXPECT_NE(force_N, 0);
  EXPECT_NEAR(bench.aux.analogue[0], force_N, kSharedRelative * std::abs(force_N));
}

void expect_same_bits(const SharedBench& a, const SharedBench& b) {
  for (std::size_t device = 0; device < 2; ++device) {
    EXPECT_EQ(a.truth(device).position_m, b.truth(device).position_m);
    EXPECT_EQ(a.truth(device).velocity_m_s, b.truth(device).velocity_m_s);
    EXPECT_EQ(a.truth(device).effort_work_J, b.truth(device).effort_work_J);
  }
  EXPECT_EQ(a.samples[0].raw, b.samples[0].raw);
}

TEST(SharedHand, RunsAllWithTheFirstDeviceThatAsksWhicheverThatIs) {
  SharedBench forwards(dense_hand(), two_devices()), backwards(dense_hand(), two_devices());
  backwards.backwards = true;
  run(forwards, 200);
  run(backwards, 200);
  expect_same_bits(forwards, backwards);
}

TEST(SharedHand, ConnectingAgainRepeatsTheRunBitByBit) {
  SharedBench first(dense_hand(), two_devices()), again(dense_hand(), two_devices());
  run(first, 200);
  run(again, 57);
  again.connect();
  EXPECT_EQ(again.truth(0).velocity_m_s, 0.1);
  EXPECT_EQ(again.truth(1).effort_work_J, 0);
  run(again, 200);
  expect_same_bits(first, again);
}

TEST(SharedHand, MissedTicksHoldTheLastEfforts) {
  std::vector<DeviceOptions> devices = two_devices();
  for (DeviceOptions& device : devices) device.axes[0].noise_counts = 0;
  SharedBench gap(dense_hand(), devices), steady(dense_hand(), devices);
  run(gap, 10);
  run(steady, 10);
  gap.read(4);
  for (int i = 0; i < 5; ++i) steady.read();
  expect_same_bits(gap, steady);
}

TEST(SharedHand, ALongGapIsMadeUpForByOneSecondOnly) {
  SharedBench gap(dense_hand(), two_devices()), second(dense_hand(), two_devices());
  gap.read(1'000'000'000);
  for (int i = 0; i < 1000; ++i) second.read();
  EXPECT_EQ(gap.truth(1).position_m, second.truth(1).position_m);
}

TEST(SharedHand, NeverCallsTheHeapInTheLoop) {
  if (!test::HeapGuard::available())
    GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  std::vector<DeviceOptions> devices = two_devices();
  devices[0].force_sensor.emplace();
  SharedBench bench(dense_hand(), devices);
  const test::HeapGuard guard;
  run(bench, 100);
  bench.read(7);
  EXPECT_EQ(guard.calls(), 0);
}

}  // namespace
}  // namespace hapticd::sim
