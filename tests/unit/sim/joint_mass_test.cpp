// Mass matrix and what goes with it: against the five-bar's reference values, textbook forms, and
// Lagrange's equation on the mass matrix alone.
#include "sim/joint_mass.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

#include "five_bar.h"

namespace hapticd::sim {
namespace {

Joints joints(double first, double second, double third = 0) {
  Joints result = Joints::Zero();
  result.head<3>() << first, second, third;
  return result;
}

JointMass mass_of(const DeviceOptions& options) {
  return {*options.linkage, options.axes, options.hand.mass_kg};
}

JointMatrix mass_at(const JointMass& mass, const Joints& q) {
  JointDynamics at;
  EXPECT_TRUE(mass.dynamics(q, Joints::Zero(), at));
  return at.mass;
}

TEST(JointMass, OfTheFiveBarIsThatOfTheReference) {
  const JointMass mass = mass_of(five_bar());
  const auto reference = five_bar_reference();
  for (const auto& pose : reference["poses"]) {
    JointDynamics at;
    ASSERT_TRUE(mass.dynamics(joints(pose["theta"][0], pose["theta"][1]), Joints::Zero(), at));
    const Eigen::Matrix2d m = at.mass.topLeftCorner<2, 2>();
    const Eigen::Matrix2d inverse = at.points.point[0].jacobian.topLeftCorner<2, 2>().inverse();
    const Eigen::Matrix2d at_tip = inverse.transpose() * m * inverse;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      EXPECT_NEAR(at.points.point[0].at[row], pose["tip_m"][i].get<double>(), 1e-10);
      for (std::size_t k = 0; k < 2; ++k) {
        const auto column = static_cast<Eigen::Index>(k);
        EXPECT_NEAR(m(row, column), pose["M"][i][k].get<double>(), 1e-13) << pose;
        EXPECT_NEAR(at_tip(row, column), pose["Mx"][i][k].get<double>(), 1e-10) << pose;
      }
    }
  }
}

// M = [a + 2 b cos q2, c + b cos q2; ., c] with point masses at the ends of the links,
// a = (m1 + m2) l1^2 + m2 l2^2, b = m2 l1 l2, c = m2 l2^2; Coriolis b sin q2 [q2' (2 q1' + q2');
// -q1'^2]; weight along -y.
TEST(JointMass, OfTwoLinksInAPlaneIsTheTextbooks) {
  const double l1 = 0.3, l2 = 0.2, m1 = 0.5, m2 = 0.25, g = 9.81;
  control::Serial chain;
  chain.joints = 2;
  chain.joint[0] = {.a = l1, .mass = m1};  // centres at the frames: at the ends of the links
  chain.joint[1] = {.a = l2, .mass = m2};
  DeviceOptions options;
  options.axes.assign(2, {.mass_kg = 0.01});
  options.linkage = LinkageOptions{.geometry = chain, .gravity = {0, -g, 0}};
  const double q1 = 0.7, q2 = -1.1, v1 = 1.3, v2 = -2.1;
  JointDynamics at;
  ASSERT_TRUE(mass_of(options).dynamics(joints(q1, q2), joints(v1, v2), at));
  const double b = m2 * l1 * l2 * std::cos(q2), c = m2 * l2 * l2;
  EXPECT_NEAR(at.mass(0, 0), 0.01 + (m1 + m2) * l1 * l1 + c + 2 * b, 1e-15);
  EXPECT_NEAR(at.mass(0, 1), c + b, 1e-15);
  EXPECT_NEAR(at.mass(1, 1), 0.01 + c, 1e-15);
  const double s = m2 * l1 * l2 * std::sin(q2);
  const double weight2 = m2 * g * l2 * std::cos(q1 + q2);
  const double weight1 = (m1 + m2) * g * l1 * std::cos(q1) + weight2;
  EXPECT_NEAR(at.load[0], s * v2 * (2 * v1 + v2) - weight1, 1e-11);
  EXPECT_NEAR(at.load[1], -s * v1 * v1 - weight2, 1e-11);
  EXPECT_NEAR(at.weight_J, g * ((m1 + m2) * l1 * std::sin(q1) + m2 * l2 * std::sin(q1 + q2)),
              1e-14);
}

struct Pose {
  const char* name;
  DeviceOptions options;
  Joints q, qd;
};

control::Delta falcon() {
  control::Delta delta;
  delta.a = 0.06, delta.b = 0.1025, delta.c = 0.01443, delta.d = delta.e = 0.01125;
  delta.f = -0.025, delta.r = 0.04, delta.s = -0.02309;
  delta.home = {0, 0, 0.11};
  for (int i = 0; i < 3; ++i) {
    const double angle = (105 - 120 * i) * M_PI / 180;
    delta.leg[static_cast<std::size_t>(i)] = {std::cos(angle), std::sin(angle)};
  }
  return delta;
}

std::vector<Pose> poses() {
  DeviceOptions bars = five_bar();
  bars.hand.mass_kg = 0.1;
  DeviceOptions delta;
  delta.axes.assign(3, {.mass_kg = 1e-4});
  delta.linkage = LinkageOptions{.geometry = falcon(), .tip_kg = 0.2};
  control::Serial chain;
  chain.joints = 3;
  chain.joint[0] = {.d = 0.1,
                    .a = 0.05,
                    .cos_twist = 0,
                    .sin_twist = 1,
                    .mass = 0.3,
                    .center = {0.01, -0.02, 0.03}};
  chain.joint[1] = {.a = 0.2, .mass = 0.2, .center = {-0.1, 0.01, 0.02}};
  chain.joint[2] = {.cos_twist = 0.6,
                    .sin_twist = 0.8,
                    .prismatic = true,
                    .mass = 0.1,
                    .center = {0.02, 0, -0.03}};
  DeviceOptions arm;
  arm.axes.assign(3, {.mass_kg = 1e-3});
  arm.linkage = LinkageOptions{.geometry = chain, .tip_kg = 0.15};
  // Arms of the delta where its tip is near (0.01, 0.005, 0.11).
  double q[3] = {};
  EXPECT_TRUE(joints_of(falcon(), {0.01, 0.005, 0.11}, q));
  return {{"five-bar", bars, joints(2.1, 0.8), joints(2, -1.5)},
          {"delta", delta, joints(q[0], q[1], q[2]), joints(1.5, -2, 0.7)},
          {"arm with a slide", arm, joints(0.4, -0.8, 0.1), joints(1.1, -2, 0.3)}};
}

// Without weight load = -(dM/dt) q' + d(q' M q' / 2)/dq, by differences of M over 1e-4.
TEST(JointMass, CentrifugalAndCoriolisFollowFromTheMassByLagrange) {
  for (const Pose& pose : poses()) {
    const JointMass mass = mass_of(pose.options);
    const auto slope = [&](const Joints& way) -> JointMatrix {
      const double h = 1e-4;
      return (mass_at(mass, pose.q + h * way) - mass_at(mass, pose.q - h * way)) / (2 * h);
    };
    Joints expected = -slope(pose.qd) * pose.qd;
    const auto count = static_cast<int>(pose.options.axes.size());
    for (int i = 0; i < count; ++i)
      expected[i] += 0.5 * pose.qd.dot(slope(Joints::Unit(i)) * pose.qd);
    JointDynamics at;
    ASSERT_TRUE(mass.dynamics(pose.q, pose.qd, at)) << pose.name;
    EXPECT_GT(expected.norm(), 1e-4) << pose.name;
    EXPECT_LT((at.load - expected).norm(), 2e-6 * expected.norm()) << pose.name;
  }
}

TEST(JointMass, WeightIsTheSlopeOfItsEnergy) {
  for (Pose& pose : poses()) {
    pose.options.linkage->gravity = {1, -9, 3};
    const JointMass mass = mass_of(pose.options);
    JointDynamics at, up, down;
    ASSERT_TRUE(mass.dynamics(pose.q, Joints::Zero(), at));
    for (int i = 0; i < static_cast<int>(pose.options.axes.size()); ++i) {
      const double h = 1e-5;
      ASSERT_TRUE(mass.dynamics(pose.q + h * Joints::Unit(i), Joints::Zero(), up));
      ASSERT_TRUE(mass.dynamics(pose.q - h * Joints::Unit(i), Joints::Zero(), down));
      EXPECT_NEAR(at.load[i], (down.weight_J - up.weight_J) / (2 * h), 1e-8) << pose.name;
    }
  }
}

// Tip and rods hang at their middles: m_t P + sum m_p (A + E)/2 + m_d (E + P)/2 times -g; the part of
// the fixed bases is left out.
TEST(JointMass, RodsOfTheFiveBarHangAtTheirMiddles) {
  DeviceOptions options = five_bar();
  options.linkage->gravity = {0, -10, 0};
  JointDynamics at;
  const double q1 = 2.1, q2 = 0.8;
  ASSERT_TRUE(mass_of(options).dynamics(joints(q1, q2), Joints::Zero(), at));
  const double elbows = 0.2 * (std::sin(q1) + std::sin(q2)), tip = at.points.point[0].at.y();
  EXPECT_NEAR(at.weight_J, 10 * (0.003 * tip + 0.005 * elbows + 0.003 * (elbows + 2 * tip)), 1e-15);
}

TEST(JointMass, HandIsMassWithoutWeight) {
  DeviceOptions options = five_bar();
  options.linkage->gravity = {0, -10, 0};
  const Joints q = joints(2.1, 0.8);
  JointDynamics alone, held;
  ASSERT_TRUE(mass_of(options).dynamics(q, Joints::Zero(), alone));
  options.hand.mass_kg = 0.3;
  ASSERT_TRUE(mass_of(options).dynamics(q, Joints::Zero(), held));
  const PointJacobian& j = alone.points.point[0].jacobian;
  EXPECT_LT((held.mass - alone.mass - 0.3 * j.transpose() * j).norm(), 1e-15);
  EXPECT_EQ(held.load, alone.load);
}

TEST(JointMass, WhereLinksDoNotMeetThereIsNone) {
  JointDynamics at;
  EXPECT_FALSE(mass_of(five_bar()).dynamics(joints(M_PI, 0), Joints::Zero(), at));
}

}  // namespace
}  // namespace hapticd::sim
