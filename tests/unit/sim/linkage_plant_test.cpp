// The linkage against the reference's free motion, and what friction, stops and the hand may do.
#include "sim/linkage_plant.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "five_bar.h"
#include "tests/support/generators.h"

namespace hapticd::sim {
namespace {

Joints pair(double first, double second) {
  Joints result = Joints::Zero();
  result.head<2>() << first, second;
  return result;
}

TEST(LinkagePlant, FreeMotionIsThatOfTheReference) {
  const auto motion = five_bar_reference()["free_motion"];
  LinkagePlant plant(five_bar());
  plant.set_velocity(pair(motion["qd"][0], motion["qd"][1]));
  const double start_J = plant.energy_J(0);
  for (int i = 0; i < 250; ++i) plant.advance(0.2e-3, {});
  for (std::size_t k = 0; k < 2; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(plant.q()[i], motion["theta"][k].get<double>(), 1e-11);
    EXPECT_NEAR(plant.tip()[i], motion["then_tip_m"][k].get<double>(), 6e-10);  // nine digits given
  }
  EXPECT_NEAR(plant.energy_J(0), start_J, 1e-12 * start_J);
}

// Swings about where it started on the hand's spring.
double largest_drift(int substeps) {
  DeviceOptions options = five_bar();
  options.hand.stiffness_N_m = 20;
  options.hand.mass_kg = 0.05;
  LinkagePlant plant(options);
  plant.set_velocity(pair(2, 1.9));
  const double start_J = plant.energy_J(0);
  double largest = 0;
  for (int i = 0; i < 1000 * substeps; ++i) {
    plant.advance(1e-3 / substeps, {});
    largest = std::max(largest, std::abs(plant.energy_J(0) / start_J - 1));
  }
  return largest;
}

TEST(LinkagePlant, TwoSubstepsKeepTheEnergyOfASecondToABillionth) {
  EXPECT_LT(largest_drift(2), 1e-9);
  EXPECT_LT(largest_drift(10), 1e-12);
}

// A swing on the tip's spring along y at the paper's pose: both joints move alike, the mass at the
// tip is Mx11 plus the hand's. Over a swing of 1 um nothing else changes.
TEST(LinkagePlant, SmallSwingHasTheFrequencyOfTheMassAtTheTip) {
  DeviceOptions options = five_bar();
  options.hand.stiffness_N_m = 100;
  options.hand.mass_kg = 0.1;
  options.linkage->hand_direction = {0, 1, 0};
  const double mass_kg = 0.1 + five_bar_reference()["poses"][0]["Mx"][1][1].get<double>();
  const double quarter_s = M_PI / 2 * std::sqrt(mass_kg / 100);
  LinkagePlant plant(options);
  for (int i = 0; i < 1000; ++i) plant.advance(quarter_s / 1000, {.rest_m = 1e-6});
  EXPECT_NEAR(plant.displacement_m(), 1e-6, 1e-11);
  EXPECT_NEAR(plant.tip_velocity().y(), 1e-6 * std::sqrt(100 / mass_kg), 1e-10);
}

TEST(LinkageFriction, HoldsEveryJointExactlyUpToItsForce) {
  DeviceOptions options = five_bar();
  for (AxisOptions& axis : options.axes) axis.coulomb_N = 2e-3;
  LinkagePlant plant(options);
  const Joints start = plant.q();
  for (const Joints& effort : {pair(2e-3, -2e-3), pair(1.9e-3, 1.9e-3), pair(-2e-3, 0)}) {
    for (int i = 0; i < 100; ++i) plant.advance(1e-4, {.effort = effort});
    EXPECT_EQ(plant.q(), start);
    EXPECT_EQ(plant.qd(), Joints::Zero());
  }
  EXPECT_EQ(plant.lost_J(), 0);
  plant.advance(1e-4, {.effort = pair(2.2e-3, 2.2e-3)});
  EXPECT_GT(plant.qd()[0], 0);
}

// One joint pushed while the other stays put: only its own inertia moves, M11, by what is beyond
// its friction.
TEST(LinkageFriction, HoldsOneJointWhileTheOtherSlides) {
  DeviceOptions options = five_bar();
  for (AxisOptions& axis : options.axes) axis.coulomb_N = 2e-3;
  LinkagePlant plant(options);
  const double held = plant.q()[1];
  plant.advance(1e-5, {.effort = pair(3e-3, 0)});
  EXPECT_EQ(plant.q()[1], held);
  const double inertia = five_bar_reference()["poses"][0]["M"][0][0];
  EXPECT_NEAR(plant.qd()[0], 1e-3 / inertia * 1e-5, 1e-10);
}

// A tip on a rail: c x = M v^2 / 2.
TEST(LinkageFriction, StopsASlidingJointWhereCoulombSays) {
  DeviceOptions options;
  options.axes = {{.mass_kg = 0.07, .coulomb_N = 0.5, .max_effort_N = 1}};
  control::LinearMap map;
  map.columns[0][0] = 1;
  options.linkage = LinkageOptions{.geometry = map, .tip_kg = 0.03};
  LinkagePlant plant(options);
  plant.set_velocity(pair(0.2, 0));
  double last = 0.2;
  for (int i = 0; i < 1000; ++i) {
    plant.advance(3e-4, {});
    ASSERT_LE(plant.qd()[0], last);
    ASSERT_GE(plant.qd()[0], 0) << "turned round";
    last = plant.qd()[0];
  }
  EXPECT_EQ(last, 0);
  EXPECT_NEAR(plant.q()[0], 0.1 * 0.2 * 0.2 / (2 * 0.5), 1e-12);
  EXPECT_NEAR(plant.lost_J(), 0.5 * 0.1 * 0.2 * 0.2, 1e-15);
}

struct Shaken {
  LinkagePlant plant;
  double start_J = 0, rest_m = 0;
  double scale_J = 0;
  explicit Shaken(const DeviceOptions& options) : plant(options), start_J(plant.energy_J(0)) {}
  void advance(double length_s, LinkageInput input) {
    input.rest_m = rest_m;
    plant.advance(length_s, input);
    rest_m += input.rest_rate_m_s * length_s;
    scale_J = std::max(scale_J, plant.lost_J());
  }
  /// What the books do not explain [J].
  double gap_J() {
    return plant.energy_J(rest_m) - start_J - plant.effort_work_J(0) - plant.effort_work_J(1) -
           plant.hand_work_J() + plant.lost_J();
  }
};

DeviceOptions rubbing() {
  DeviceOptions options = five_bar();
  for (AxisOptions& axis : options.axes) axis.damping_Ns_m = 8e-4, axis.coulomb_N = 2e-3;
  options.hand.mass_kg = 0.05;
  options.hand.stiffness_N_m = 200;
  options.hand.damping_Ns_m = 1;
  options.linkage->gravity = {0, -9.81, 0};
  options.linkage->hand_direction = {0.6, 0.8, 0};
  return options;
}

TEST(LinkagePlant, EnergyIsWhatEffortsAndHandPutInLessWhatFrictionTook) {
  Shaken shaken(rubbing());
  for (int i = 0; i < 10'000; ++i) {
    LinkageInput input;
    input.effort = pair(0.02 * ((i / 700) % 3 - 1), 0.03 * ((i / 500) % 2));
    input.force_N = (i / 900) % 3 - 1;
    input.rest_rate_m_s = (i / 1000) % 2 == 0 ? -0.01 : 0.01;
    shaken.advance(1e-4, input);
    ASSERT_NEAR(shaken.gap_J(), 0, 1e-9 * std::max(shaken.scale_J, 1e-3)) << "sub-step " << i;
  }
  EXPECT_GT(shaken.scale_J, 0.01) << "hardly anything happened";
}

// Whatever pushes: each sub-step's loss is >= 0, and explains all that is missing.
RC_GTEST_PROP(LinkageFriction, NeverAddsEnergy, ()) {
  DeviceOptions options = rubbing();
  options.hand.stiffness_N_m = test::any_number(0, 1000);
  for (AxisOptions& axis : options.axes) axis.coulomb_N = test::any_number(0, 0.05);
  Shaken shaken(options);
  shaken.plant.set_velocity(pair(test::any_number(-3, 3), test::any_number(-3, 3)));
  shaken.start_J = shaken.plant.energy_J(0);
  for (int i = 0; i < 100; ++i) {
    const double lost_J = shaken.plant.lost_J();
    LinkageInput input;
    input.effort = pair(test::any_number(-0.1, 0.1), test::any_number(-0.1, 0.1));
    shaken.advance(2e-4, input);
    RC_ASSERT(shaken.plant.lost_J() >= lost_J);
    RC_ASSERT(std::abs(shaken.gap_J()) < 1e-8);
  }
}

TEST(LinkageStops, TakeASwingingJointsEnergyAndHoldIt) {
  DeviceOptions options = five_bar();
  options.axes[0].stops = StopOptions{2.2, 2.4};
  options.axes[1].stops = StopOptions{0.5, 1.0};
  options.axes[0].damping_Ns_m = 1e-4;
  LinkagePlant plant(options);
  plant.set_velocity(pair(3, 0));
  double last_J = plant.energy_J(0), most = 0;
  for (int i = 0; i < 5000; ++i) {
    plant.advance(1e-4, {});
    ASSERT_LE(plant.energy_J(0), last_J * (1 + 1e-12)) << "sub-step " << i;
    last_J = plant.energy_J(0);
    most = std::max(most, plant.q()[0]);
  }
  EXPECT_GT(most, 2.4) << "never got there";
  EXPECT_LT(most, 2.41);
  EXPECT_LT(last_J, 0.1 * plant.lost_J());
}

TEST(LinkagePlant, AtTheEndOfItsReachItStopsAndTakesNoHarm) {
  LinkagePlant plant(five_bar());
  for (int i = 0; i < 5000; ++i) plant.advance(1e-4, {.effort = pair(0.4, -0.4)});
  EXPECT_TRUE(plant.q().allFinite());
  EXPECT_TRUE(std::isfinite(plant.energy_J(0)));
  EXPECT_GT(plant.lost_J(), 0);
}

TEST(LinkageHand, PushesTheSensorByItsForceLessWhatItsMassTakes) {
  DeviceOptions options;
  options.axes = {{.mass_kg = 0.07, .max_effort_N = 9}};
  control::LinearMap map;
  map.columns[1][0] = -1;  // the joint runs along -y
  options.linkage = LinkageOptions{.geometry = map, .tip_kg = 0.03, .hand_direction = {0, 1, 0}};
  options.hand = {.mass_kg = 0.3, .stiffness_N_m = 50, .damping_Ns_m = 2, .script = {}};
  LinkagePlant plant(options);
  plant.set_velocity(pair(-0.5, 0));  // tip: 0.5 m/s along +y
  const double held = 3 - 50 * (0 - 0.01) - 2 * 0.5;
  const double acceleration = (held - 1.2) / 0.4;  // the joint's effort of 1.2 N pushes along -y
  LinkageInput input{.effort = pair(1.2, 0), .force_N = 3, .rest_m = 0.01};
  const Eigen::Vector3d force = plant.hand_force_N(input);
  EXPECT_NEAR(force.y(), held - 0.3 * acceleration, 1e-13);
  EXPECT_EQ(force.x(), 0);
}

}  // namespace
}  // namespace hapticd::sim
