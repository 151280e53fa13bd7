// Reference: homogeneous transforms multiplied out joint by joint, and closed forms of simple arms.
#include <gtest/gtest.h>

#include <random>

#include "tests/support/linkage_fixture.h"

namespace hapticd::control {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Translation3d;
using Eigen::Vector3d;
using test::JointAngles;

/// Frame behind `joints` joints.
Affine3d brute_force(const Serial& chain, const JointAngles& q, std::size_t joints) {
  Affine3d frame = Affine3d::Identity();
  for (std::size_t j = 0; j < joints; ++j) {
    const DhJoint& joint = chain.joint[j];
    const double twist = std::atan2(joint.sin_twist, joint.cos_twist);
    frame = frame * AngleAxisd(joint.theta + (joint.prismatic ? 0 : q[j]), Vector3d::UnitZ()) *
            Translation3d(joint.a, 0, joint.d + (joint.prismatic ? q[j] : 0)) *
            AngleAxisd(twist, Vector3d::UnitX());
  }
  return frame;
}

double potential(const Serial& chain, const JointAngles& q, const Vector3d& gravity) {
  double energy = 0;
  for (std::size_t j = 0; j < chain.joints; ++j) {
    const Vector3d center = brute_force(chain, q, j + 1) * Vector3d(chain.joint[j].center.data());
    energy -= chain.joint[j].mass * gravity.dot(center);
  }
  return energy;
}

class SerialChain : public testing::TestWithParam<Serial> {
 protected:
  JointAngles random_joints() {
    std::uniform_real_distribution<double> angle(-3, 3);
    JointAngles q{};
    for (std::size_t j = 0; j < GetParam().joints; ++j) q[j] = angle(random_);
    return q;
  }
  std::mt19937_64 random_{1};
};

TEST_P(SerialChain, TipIsThatOfTheTransformsMultipliedOut) {
  for (int i = 0; i < 500; ++i) {
    const JointAngles q = random_joints();
    LinkagePose pose;
    ASSERT_TRUE(pose_of(GetParam(), q.data(), pose));
    const Vector3d tip = brute_force(GetParam(), q, GetParam().joints).translation();
    EXPECT_LT((test::tip_of(pose) - tip).norm(), 1e-14);
  }
}

TEST_P(SerialChain, JacobianIsTheDerivativeOfTheTip) {
  for (int i = 0; i < 500; ++i) {
    const JointAngles q = random_joints();
    LinkagePose pose;
    ASSERT_TRUE(pose_of(GetParam(), q.data(), pose));
    const auto numerical = test::numerical_jacobian(GetParam(), q, GetParam().joints, pose);
    EXPECT_LT((test::jacobian_of(pose, GetParam().joints) - numerical).norm(), 1e-9);
  }
}

TEST_P(SerialChain, HoldingEffortsAreTheDerivativeOfThePotential) {
  constexpr double kStep = 1e-5;
  const Vector3d gravity(3, -5, -8);
  for (int i = 0; i < 200; ++i) {
    JointAngles q = random_joints(), effort{};
    holding_efforts(GetParam(), q.data(), {3, -5, -8}, effort.data());
    for (std::size_t j = 0; j < GetParam().joints; ++j) {
      const double middle = q[j];
      q[j] = middle + kStep;
      const double ahead = potential(GetParam(), q, gravity);
      q[j] = middle - kStep;
      const double behind = potential(GetParam(), q, gravity);
      q[j] = middle;
      EXPECT_NEAR(effort[j], (ahead - behind) / (2 * kStep), 1e-8);
    }
  }
}

TEST_P(SerialChain, NoPoseFitsWhatIsNotANumber) {
  for (std::size_t j = 0; j < GetParam().joints; ++j) {
    for (const double bad : {std::nan(""), HUGE_VAL}) {
      JointAngles q{};
      q[j] = bad;
      LinkagePose pose{.tip = {1, 2, 3}};
      EXPECT_FALSE(pose_of(GetParam(), q.data(), pose));
      EXPECT_EQ(pose.tip, (std::array<double, 3>{1, 2, 3}));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SerialChain, testing::Values(test::six_joints(), test::mixed_joints()),
                         [](const auto& chain) {
                           return chain.index == 0 ? "SixJoints" : "TurningAndSliding";
                         });

/// Two links of 0.3 and 0.2 in a plane, q from +x and from the first link.
TEST(Serial, TwoLinksInAPlaneAreTheTextbookArm) {
  const Serial arm{.joints = 2,
                   .joint = {test::revolute(0, 0, 0.3, 0), test::revolute(0, 0, 0.2, 0)}};
  LinkagePose pose;
  ASSERT_TRUE(pose_of(arm, JointAngles{0.4, 0.9}.data(), pose));
  EXPECT_NEAR(pose.tip[0], 0.3 * std::cos(0.4) + 0.2 * std::cos(1.3), 1e-15);
  EXPECT_NEAR(pose.tip[1], 0.3 * std::sin(0.4) + 0.2 * std::sin(1.3), 1e-15);
  EXPECT_NEAR(pose.jacobian[0][0], -pose.tip[1], 1e-15);
  EXPECT_NEAR(pose.jacobian[1][0], pose.tip[0], 1e-15);
  EXPECT_NEAR(pose.jacobian[0][1], -0.2 * std::sin(1.3), 1e-15);
  EXPECT_NEAR(pose.jacobian[1][1], 0.2 * std::cos(1.3), 1e-15);
}

/// A pendulum of 2 kg at 0.5 m, turning about a level axis: held upright by nothing, held out by
/// m g l.
TEST(Serial, APendulumIsHeldByItsWeightTimesItsLever) {
  Serial pendulum{.joints = 1, .joint = {test::revolute(0, 0, 0.5, 0)}};
  pendulum.joint[0].mass = 2;  // at the end of the link
  double effort = 7;
  const double level = 0, up = M_PI / 2;
  holding_efforts(pendulum, &level, {0, -9.81, 0}, &effort);
  EXPECT_NEAR(effort, 2 * 9.81 * 0.5, 1e-14);
  holding_efforts(pendulum, &up, {0, -9.81, 0}, &effort);
  EXPECT_NEAR(effort, 0, 1e-14);
}

/// A slide along z lifts the whole weight behind it.
TEST(Serial, ASlideLiftsAllThatHangsBehindIt) {
  Serial lift{.joints = 2, .joint = {test::prismatic(0, 0, 0, 0), test::revolute(0, 0, 0.3, 0)}};
  lift.joint[0].mass = 1.5;
  lift.joint[1].mass = 0.5;
  JointAngles effort{};
  holding_efforts(lift, JointAngles{0.1, 0.2}.data(), {0, 0, -10}, effort.data());
  EXPECT_NEAR(effort[0], 20, 1e-13);
  EXPECT_NEAR(effort[1], 0, 1e-15) << "turning about the vertical";
}

}  // namespace
}  // namespace hapticd::control
