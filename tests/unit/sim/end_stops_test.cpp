// The mechanical ends of an axis that is on its own.
#include "sim/end_stops.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <limits>

#include "bench_device.h"
#include "sim/plant.h"
#include "tests/support/generators.h"

namespace hapticd::sim {
namespace {

DeviceOptions between_stops() {
  DeviceOptions options = free_mass();
  options.axes[0].stops = StopOptions{-0.02, 0.03};
  return options;
}

// 100 N goes in by 0.05 m / 1000.
TEST(EndStops, HoldTheLargestEffortAThousandthOfTheTravelDeep) {
  BenchDevice bench(between_stops());
  bench.arm();
  for (const double sign : {1.0, -1.0}) {
    bench.command(sign * 100);
    for (int n = 0; n < 500; ++n) bench.read();
    const double edge_m = sign > 0 ? 0.03 : -0.02;
    EXPECT_NEAR(bench.truth().position_m, edge_m + sign * 50e-6, 1e-9);
    EXPECT_NEAR(bench.truth().velocity_m_s, 0, 1e-9);
    EXPECT_NEAR(bench.truth().energy_J, 0.5 * 100 * 50e-6, 1e-9) << "that of the stop's spring";
  }
}

TEST(EndStops, AreNotFeltBetween) {
  BenchDevice with(between_stops()), without(free_mass());
  for (BenchDevice* bench : {&with, &without}) {
    bench->arm();
    bench->command(2);
    for (int n = 0; n < 100; ++n) bench->read();
  }
  EXPECT_EQ(with.truth().position_m, without.truth().position_m);
  EXPECT_LT(with.truth().position_m, 0.03);
}

// Half of critical damping and a force that only pushes give back
// exp(-zeta / w (pi - atan(2 zeta w / (1 - 2 zeta^2)))) = 0.298 of the speed, w^2 = 1 - zeta^2
// (Schwager, Poeschel 2007).
TEST(EndStops, GiveBackThreeTenthsOfTheSpeed) {
  DeviceOptions options = between_stops();
  options.substeps = 200;
  BenchDevice bench(options);
  bench.arm();
  bench.command(10);
  while (bench.truth().max_position_m < 0.029) bench.read();
  bench.command(0);
  const double before_m_s = bench.truth().velocity_m_s;
  for (int n = 0; n < 60; ++n) bench.read();
  EXPECT_NEAR(bench.truth().velocity_m_s, -0.298 * before_m_s, 0.005 * before_m_s);
}

TEST(EndStops, OnlyPush) {
  const EndStops stops{0, 1, 1000, 10};
  EXPECT_EQ(stops.force_N(1.001, 0), -1000 * (1.001 - 1));
  EXPECT_EQ(stops.force_N(1.001, -1), 0) << "leaves faster than the spring follows";
  EXPECT_EQ(stops.force_N(-0.001, 0), 1);
  EXPECT_EQ(stops.force_N(-0.001, 1), 0);
  EXPECT_EQ(stops.force_N(0.5, 9), 0);
}

// However stiff the stop, whatever the interval: what plant and stop hold grows by no more than the
// work of the force on them.
RC_GTEST_PROP(EndStops, NeverAddEnergy, ()) {
  const double mass = test::any_number(0.01, 1), h = std::pow(10, test::any_number(-5, -2));
  const double stiffness = std::pow(10, test::any_number(1, 9));
  const EndStops stops{-0.001, 0.002, stiffness,
                       test::any_number(0, 1) * std::sqrt(stiffness * mass)};
  Plant plant({.mass_kg = mass,
               .damping_Ns_m = test::any_number(0, 1),
               .stiffness_N_m = test::any_number(0, 0.01) * mass / (h * h),
               .coulomb_N = test::any_number(0, 1),
               .stops = stops},
              test::any_number(-0.001, 0.002));
  plant.set_velocity(test::any_number(-1, 1));
  const Propagator interval = plant.propagator(h);
  for (int i = 0; i < 300; ++i) {
    const double force_N = test::any_number(-20, 20);
    const double before_J = plant.energy_J(0), before_m = plant.position_m();
    plant.advance(interval, {.force_N = force_N});
    const double work_J = force_N * (plant.position_m() - before_m);
    RC_ASSERT(plant.energy_J(0) <=
              before_J + work_J + 1e-11 * (before_J + std::abs(work_J)) + 1e-16);
  }
}

}  // namespace
}  // namespace hapticd::sim
