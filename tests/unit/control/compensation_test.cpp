#include "control/observer/compensation.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "control/build/filters.h"
#include "tests/support/held_mass.h"
#include "tests/support/period.h"
#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using build::ObserverMode;
using test::Rig;
using test::spec_of;

using test::kPeriod_s;

ObserverPlan observer(ObserverMode mode, double max_output = 10) {
  return build::observer(
      0, 0,
      {.mode = mode, .nominal_mass_kg = 0.1, .cutoff_Hz = 50, .order = 1, .max_output = max_output},
      kPeriod_s);
}

/// A planar five-bar of links of 0.2 m on bases 0.1 m apart, turned so that its y is up (world z).
build::ProgramSpec five_bar_spec() {
  build::ProgramSpec spec = spec_of(2);
  for (AxisPlan& axis : spec.axes)
    axis = {.unit_per_raw = 1, .max_effort = 12, .max_velocity = 1e3, .max_step = 1e3};
  spec.linkages = {
      {.axes = 2, .coordinates = 2, .turn = {{{1, 0, 0}, {0, 1, 0}, {}}}, .rotary = true}};
  spec.five_bars = {{.link_m = 0.2, .base_m = 0.1}};
  return spec;
}

TEST(Gravity, ConstantAndSwingFollowTheJoint) {
  auto spec = spec_of(2);
  spec.axes[0].unit_per_raw = 1e-3;
  spec.gravity_axes = {{.axis = 0, .constant = 0.5, .swing = 2, .phase = 0.25},
                       {.axis = 1, .constant = -3}};
  Rig rig(spec);
  for (const double counts : {0.0, 500.0, 1300.0}) {
    rig.samples[0].raw = counts;
    rig.again();
    EXPECT_NEAR(rig.program.state().gravity[0], 0.5 + 2 * std::cos(1e-3 * counts + 0.25), 1e-12);
    EXPECT_EQ(rig.program.state().gravity[1], -3.0) << "not summed up over the ticks";
  }
}

TEST(Gravity, TipsWeightIsScaledLikeTheContactsForce) {
  auto spec = spec_of(2);
  spec.cartesian_axes = {{.axis = 0, .coordinate = 0, .scale = -2}, {.axis = 1, .coordinate = 1}};
  spec.gravity_tips = {{.device = 0, .weight = {0.3, 0.7}}};
  spec.gravity_axes = {{.axis = 1, .constant = 1}};
  Rig rig(spec);
  rig.again();
  rig.again();
  EXPECT_NEAR(rig.program.state().gravity[0], -0.6, 1e-15);
  EXPECT_NEAR(rig.program.state().gravity[1], 1.7, 1e-15);
}

// Virtual work: the effort at a joint is the slope of the tip's potential energy.
TEST(Gravity, TipsWeightOnALinkageIsTheSlopeOfItsEnergy) {
  auto spec = five_bar_spec();
  spec.gravity_tips = {{.device = 0, .weight = {0.2, 1.5}}};
  Rig rig(spec);
  const std::array<double, 2> q = {2.0226, 0.6751};
  const auto energy_at = [&](double q0, double q1) {
    rig.samples[0].raw = q0;
    rig.samples[1].raw = q1;
    rig.again();
    return 0.2 * rig.program.state().x[0] + 1.5 * rig.program.state().x[1];
  };
  const double h = 1e-6;
  const double first = (energy_at(q[0] + h, q[1]) - energy_at(q[0] - h, q[1])) / (2 * h);
  const double second = (energy_at(q[0], q[1] + h) - energy_at(q[0], q[1] - h)) / (2 * h);
  energy_at(q[0], q[1]);
  ASSERT_GT(std::abs(first), 0.05);
  EXPECT_NEAR(rig.program.state().gravity[0], first, 1e-8);
  EXPECT_NEAR(rig.program.state().gravity[1], second, 1e-8);
}

// One link about a horizontal axis: m g l cos q at the joint.
TEST(Gravity, SerialLinksAreHeldUp) {
  auto spec = spec_of(1);
  spec.axes[0].unit_per_raw = 1e-3;
  spec.linkages = {{.axes = 1, .coordinates = 1, .turn = {{{1, 0, 0}}}, .rotary = true}};
  Serial chain{.joints = 1, .gravity = {0, -9.81, 0}};
  chain.joint[0] = {.a = 0.3, .mass = 0.4, .center = {-0.1, 0, 0}};
  spec.serials = {chain};
  spec.gravity_axes = {{.axis = 0, .constant = 0.25}};
  Rig rig(spec);
  for (const double counts : {0.0, 700.0, 2000.0}) {
    rig.samples[0].raw = counts;
    rig.again();
    EXPECT_NEAR(rig.program.state().gravity[0], 0.25 + 0.4 * 9.81 * 0.2 * std::cos(1e-3 * counts),
                1e-12);
  }
}

TEST(Friction, ViscousAndCoulombWithASlopeAtRest) {
  auto spec = spec_of(1);
  spec.frictions = {{.axis = 0, .viscous = 0.3, .coulomb = 0.5, .smooth = 0.02}};
  Rig rig(spec);
  double x = 0;
  rig.at(x);
  for (const double v : {0.01, 0.02, 0.5, -0.005, -1.0, 0.0}) {
    rig.at(x += v * kPeriod_s);
    const double sign = std::min(1.0, std::max(-1.0, v / 0.02));
    EXPECT_NEAR(rig.program.state().friction[0], 0.3 * v + 0.5 * sign, 1e-9) << v;
  }
}

/// m/s: the fastest that an axis still is 4 s after it was let go at 0.05 m/s, whose true damping is
/// 0.1 N s/m and whose Coulomb friction, believed to be 0.04 N, is `true_coulomb_N`, at standstill
/// half as much again.
double late_speed(double smooth_m_s, double true_coulomb_N) {
  auto spec = spec_of(1);
  spec.frictions = {{.axis = 0, .coulomb = 0.04, .smooth = smooth_m_s}};
  spec.devices[0].ramp_per_tick = 1;
  Rig rig(spec);
  rig.input.enable = true;
  constexpr double kMass_kg = 0.05, kDamping_Ns_m = 0.1;
  double x = 0, v = 0.05, late = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const double effort = rig.at(x).effort[0];
    for (int i = 0; i < 100; ++i) {
      const double step_s = kPeriod_s / 100;
      const bool stuck = v == 0 && std::abs(effort) <= 1.5 * true_coulomb_N;
      const double slid = v + (effort - kDamping_Ns_m * v) / kMass_kg * step_s;
      const double friction = true_coulomb_N / kMass_kg * step_s;
      v = stuck || std::abs(slid) <= friction ? 0 : slid - std::copysign(friction, slid);
      x += v * step_s;
    }
    if (tick >= 3500) late = std::max(late, std::abs(v));
  }
  return late;
}

// Slope at rest 0.04 N / smooth against 0.1 N s/m of true damping.
TEST(Friction, DeviceComesToRestWhileTheSlopeStaysBelowItsDamping) {
  EXPECT_LT(late_speed(0.8, 0.05), 1e-4);
  // Even without the Coulomb friction that is compensated: e^-1/s is left of the damping.
  EXPECT_NEAR(late_speed(0.8, 0.0), 0.05 * std::exp(-3.5), 1e-4);
}

TEST(Friction, DeviceWouldRunOnByItselfWithASteeperSlope) {
  EXPECT_GT(late_speed(0.01, 0.0), 0.1);
}

TEST(ForceSensor, ChannelsAreTurnedIntoTheContact) {
  auto spec = spec_of(2);
  spec.force_sensors = {{.device = 0, .channels = 3, .turn = {{{1, 2, 3}, {0, -1, 0.5}, {}}}}};
  Rig rig(spec);
  rig.aux[0].analogue = {1, 10, 100, 1e9};
  rig.again();
  EXPECT_EQ(rig.program.state().hand_force[0], 321.0);
  EXPECT_EQ(rig.program.state().hand_force[1], 40.0);
}

TEST(ForceSensor, ReadingThatIsNoNumberLeavesTheLast) {
  auto spec = spec_of(1);
  spec.force_sensors = {{.device = 0, .channels = 1, .turn = {{{1, 0, 0}}}}};
  Rig rig(spec);
  rig.aux[0].analogue[0] = 2;
  rig.again();
  rig.aux[0].analogue[0] = std::numeric_limits<double>::quiet_NaN();
  rig.again();
  EXPECT_EQ(rig.program.state().hand_force[0], 2.0);
}

// A device that stands still because gravity is held: nothing is left for the observer to see.
TEST(AxisObserver, EffortThatHoldsTheWeightIsNoCommand) {
  auto spec = spec_of(1);
  spec.gravity_axes = {{.axis = 0, .constant = 1.5}};
  spec.axis_observers = {observer(ObserverMode::classic)};
  Rig rig(spec);
  rig.enable_at(0);
  for (int i = 0; i < 50; ++i) rig.at(0);
  EXPECT_NEAR(rig.delivered[0], 1.5, 1e-12);
  EXPECT_NEAR(rig.program.state().residual[0], 0, 1e-12);
}

TEST(AxisObserver, ObservesWhatTheDeviceDelivered) {
  auto spec = spec_of(1);
  spec.axis_observers = {observer(ObserverMode::classic)};
  Rig rig(spec);
  rig.enable_at(0);
  for (int i = 0; i < 3; ++i) {
    rig.delivered[0] = 2;  // whatever was asked of it
    rig.at(0);
  }
  EXPECT_NEAR(rig.program.state().residual[0], -2, 1e-12) << "2 N that moved nothing";
}

TEST(AxisObserver, SensedHandIsNoDisturbance) {
  auto spec = spec_of(1);
  spec.cartesian_axes = {{.axis = 0, .coordinate = 0, .scale = -0.5}};
  spec.force_sensors = {{.device = 0, .channels = 1, .turn = {{{1, 0, 0}}}}};
  spec.axis_observers = {observer(ObserverMode::sensor)};
  Rig rig(spec);
  rig.aux[0].analogue[0] = 3;
  for (int i = 0; i < 10; ++i) rig.at(0);
  EXPECT_NEAR(rig.program.state().residual[0], 0.5 * 3, 1e-12) << "3 N at the contact, -1.5 N here";
}

TEST(AxisObserver, BoundIsToldOnlyWhileForcesAreOn) {
  auto spec = spec_of(1);
  spec.axis_observers = {observer(ObserverMode::model, 0.1)};
  Rig rig(spec);
  double x = 0;
  const auto accelerate = [&] {  // 20 m/s^2 of 0.1 kg: 2 N
    TickOutput output;
    for (int i = 1; i <= 40; ++i) output = rig.at(x += 20e-6 * i);
    return output;
  };
  EXPECT_FALSE(accelerate().limits.has(Limit::compensation));
  EXPECT_EQ(rig.program.state().observer[0], -0.1);
  rig.enable_at(x);
  for (int i = 0; i < 200; ++i) rig.at(x);
  EXPECT_FALSE(rig.at(x).limits.has(Limit::compensation));
  EXPECT_TRUE(accelerate().limits.has(Limit::compensation));
}

TEST(ContactObserver, WorksInTheContactsCoordinates) {
  auto spec = spec_of(2);
  spec.cartesian_axes = {{.axis = 0, .coordinate = 1, .scale = 2}, {.axis = 1, .coordinate = 0}};
  spec.contact_observers = {observer(ObserverMode::model)};
  spec.contact_observers[0].source = 1;
  Rig rig(spec);
  double x = 0;
  for (int i = 0; i < 20; ++i) rig.at(x += 1e-6 * i);
  EXPECT_NEAR(rig.program.state().contact_residual[1], 0.1 * 2 * 1.0, 1e-8) << "1 m/s^2, twice";
  EXPECT_EQ(rig.program.state().contact_residual[0], 0.0);
  EXPECT_LT(rig.program.state().observer_force[1], -0.1);
}

// One axis of a contact without a sample: the contact as a whole has not moved on by one period.
TEST(ContactObserver, OneHeldAxisIsAGapForTheWholeContact) {
  auto spec = spec_of(2);
  spec.contact_observers = {observer(ObserverMode::model)};
  Rig rig(spec);
  double x = 0;
  for (int i = 0; i < 20; ++i) rig.at(x += 1e-6 * i);
  const double kept = rig.program.state().contact_observers[0].s2;
  rig.samples[0].raw = Rig::raw(x);
  rig.samples[1].freshness = Freshness::missing;
  rig.run();
  EXPECT_EQ(rig.program.state().contact_observers[0].s2, kept);
  rig.at(x);
  EXPECT_EQ(rig.program.state().contact_observers[0].s2, kept);
}

}  // namespace
}  // namespace hapticd::control
