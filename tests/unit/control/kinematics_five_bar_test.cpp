// Reference: an independent implementation (tests/data/kinematics/five_bar.json).
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/linkage_fixture.h"

namespace hapticd::control {
namespace {

using Eigen::Vector2d;
using test::five_bar;
using test::JointAngles;

/// Calls `check(q, pose)` all over the angles that have a pose with some distance to singular ones.
template <class Check>
int over_the_workspace(Check check) {
  int poses = 0;
  for (double q1 = 0; q1 < 2 * M_PI; q1 += 0.1) {
    for (double q2 = -M_PI; q2 < M_PI; q2 += 0.1) {
      const JointAngles q{q1, q2};
      LinkagePose pose;
      if (!pose_of(five_bar(), q.data(), pose)) continue;
      const double apart = std::hypot(0.1 + 0.2 * (std::cos(q2) - std::cos(q1)),
                                      0.2 * (std::sin(q2) - std::sin(q1)));
      if (apart < 0.02 || apart > 0.39) continue;  // outer links close to one line
      check(q, pose);
      ++poses;
    }
  }
  return poses;
}

TEST(FiveBar, TipJointsAndJacobianAreThoseOfTheReference) {
  const auto data = test::kinematics_data("five_bar");
  const FiveBar bars{.link_m = data["link_m"], .base_m = data["base_m"]};
  ASSERT_EQ(data["vectors"].size(), 5u);
  for (const auto& vector : data["vectors"]) {
    const std::array<double, 3> tip{vector["P"][0], vector["P"][1], 0};
    JointAngles q{};
    ASSERT_TRUE(joints_of(bars, tip, q.data()));
    LinkagePose pose;
    const JointAngles given{vector["theta"][0], vector["theta"][1]};
    ASSERT_TRUE(pose_of(bars, given.data(), pose));
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_NEAR(q[i], given[i], 1e-10);
      EXPECT_NEAR(pose.tip[i], tip[i], 1e-10);
      for (std::size_t j = 0; j < 2; ++j)
        EXPECT_NEAR(pose.jacobian[i][j], vector["J"][i][j].get<double>(), 1e-10);
      EXPECT_NEAR(pose.jacobian[0][i] * 1 + pose.jacobian[1][i] * -2,
                  vector["tau_for_F_1_m2"][i].get<double>(), 1e-10);
    }
    EXPECT_EQ(pose.tip[2], 0);
  }
}

TEST(FiveBar, JacobianIsTheDerivativeOfTheTipAllOverTheWorkspace) {
  double worst = 0;
  const int poses = over_the_workspace([&](const JointAngles& q, const LinkagePose& pose) {
    const auto jacobian = test::jacobian_of(pose, 2);
    const auto numerical = test::numerical_jacobian(five_bar(), q, 2, pose);
    worst = std::fmax(worst, (jacobian - numerical).norm() / jacobian.norm());
  });
  EXPECT_GT(poses, 2000);
  EXPECT_LT(worst, 1e-6);
}

TEST(FiveBar, EveryLinkKeepsItsLengthAndTheTipIsOnTheUpperBranch) {
  const int poses = over_the_workspace([](const JointAngles& q, const LinkagePose& pose) {
    const Vector2d tip(pose.tip[0], pose.tip[1]);
    const Vector2d elbow1(-0.05 + 0.2 * std::cos(q[0]), 0.2 * std::sin(q[0]));
    const Vector2d elbow2(0.05 + 0.2 * std::cos(q[1]), 0.2 * std::sin(q[1]));
    EXPECT_NEAR((tip - elbow1).norm(), 0.2, 1e-14);
    EXPECT_NEAR((tip - elbow2).norm(), 0.2, 1e-14);
    const Vector2d across = elbow2 - elbow1, to_tip = tip - elbow1;
    EXPECT_GT(across.x() * to_tip.y() - across.y() * to_tip.x(), 0) << "left of elbow 1 to 2";
  });
  EXPECT_GT(poses, 2000);
}

TEST(FiveBar, ATipBeyondTheLinksHasNoJoints) {
  JointAngles q{7, 7};
  EXPECT_TRUE(joints_of(five_bar(), {0, 0.396, 0}, q.data()));  // 2 l reaches 0.39686 here
  q = {7, 7};
  EXPECT_FALSE(joints_of(five_bar(), {0, 0.398, 0}, q.data()));
  EXPECT_FALSE(joints_of(five_bar(), {0.36, 0, 0}, q.data()));
  EXPECT_FALSE(joints_of(five_bar(), {std::nan(""), 0.25, 0}, q.data()));
  EXPECT_EQ(q[0], 7) << "left alone";
}

TEST(FiveBar, ElbowsTooFarApartHaveNoPoseAndLeaveTheLastAlone) {
  LinkagePose pose{.tip = {1, 2, 3}};
  const JointAngles apart{M_PI, 0};  // elbows 0.5 apart, outer links reach 0.4
  EXPECT_FALSE(pose_of(five_bar(), apart.data(), pose));
  EXPECT_EQ(pose.tip, (std::array<double, 3>{1, 2, 3}));
}

/// |D| = 0.1 + 0.4 cos(q2) for q1 = pi - q2: the sine of the angle between the outer links is
/// |D| h / l^2.
TEST(FiveBar, OuterLinksInOneLineAreNoPose) {
  const auto fits = [](double sine) {
    const double half_angle = std::asin(sine) / 2;  // outer links that point apart
    const double q2 = std::acos((0.4 * std::cos(half_angle) - 0.1) / 0.4);
    const JointAngles q{M_PI - q2, q2};
    LinkagePose pose;
    return pose_of(five_bar(), q.data(), pose);
  };
  EXPECT_TRUE(fits(1.01e-3));
  EXPECT_FALSE(fits(0.99e-3));
  LinkagePose pose;
  const double together = std::acos(-0.25);  // elbows in the same place
  EXPECT_FALSE(pose_of(five_bar(), JointAngles{M_PI - together, together}.data(), pose));
}

TEST(FiveBar, NoPoseFitsWhatIsNotANumber) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -HUGE_VAL}) {
    LinkagePose pose;
    EXPECT_FALSE(pose_of(five_bar(), JointAngles{bad, 0.9}.data(), pose));
    EXPECT_FALSE(pose_of(five_bar(), JointAngles{2.2, bad}.data(), pose));
  }
}

}  // namespace
}  // namespace hapticd::control
