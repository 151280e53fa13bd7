// Reference: an independent implementation (tests/data/kinematics/falcon.json), and the closed
// inverse, which shares no formula with Newton's forward solution but the geometry.
#include <gtest/gtest.h>

#include "tests/support/linkage_fixture.h"
#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::falcon;
using test::JointAngles;

struct Box {
  double aside, low, high;  // m
};
constexpr Box kBox{0.05, 0.08, 0.17};      ///< where a Falcon's hand moves
constexpr Box kWideBox{0.06, 0.05, 0.18};  ///< beyond it, up to where arms are stretched

/// Calls `check(tip, q)` all over the box, a centimetre apart, where the arms reach.
template <class Check>
int all_over(const Box& box, Check check) {
  int places = 0;
  for (double x = -box.aside; x < box.aside + 1e-4; x += 0.01) {
    for (double y = -box.aside; y < box.aside + 1e-4; y += 0.01) {
      for (double z = box.low; z < box.high + 1e-4; z += 0.01) {
        JointAngles q{};
        if (!joints_of(falcon(), {x, y, z}, q.data())) continue;
        check(Vector3d(x, y, z), q);
        ++places;
      }
    }
  }
  return places;
}

std::array<double, 3> array_of(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

TEST(Delta, TipJointsJacobianAndTorquesAreThoseOfTheReference) {
  const auto data = test::kinematics_data("falcon");
  ASSERT_EQ(data["poses"].size(), 5u);
  for (const auto& vector : data["poses"]) {
    const std::array<double, 3> tip = vector["position_m"];
    JointAngles q{};
    ASSERT_TRUE(joints_of(falcon(), tip, q.data()));
    LinkagePose pose{.tip = falcon().home};
    const std::array<double, 3> given = vector["theta1_rad"];
    ASSERT_TRUE(pose_of(falcon(), given.data(), pose));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(q[i], given[i], 1e-9);
      EXPECT_NEAR(pose.tip[i], tip[i], 1e-9);
      double torque = 0;
      for (std::size_t j = 0; j < 3; ++j) {
        EXPECT_NEAR(pose.jacobian[i][j], vector["J_dp_dtheta"][i][j].get<double>(), 1e-8);
        torque += pose.jacobian[j][i] * vector["force_N"][j].get<double>();
      }
      EXPECT_NEAR(torque, vector["leg_torque_Nm"][i].get<double>(), 1e-8);
    }
  }
}

TEST(Delta, PlacesOutOfReachHaveNoJoints) {
  const auto data = test::kinematics_data("falcon");
  ASSERT_EQ(data["unreachable"].size(), 2u);
  for (const auto& place : data["unreachable"]) {
    JointAngles q{7, 7, 7};
    EXPECT_FALSE(joints_of(falcon(), place["position_m"].get<std::array<double, 3>>(), q.data()))
        << place["why"];
    EXPECT_EQ(q[0], 7) << "left alone";
  }
  JointAngles q{};
  EXPECT_FALSE(joints_of(falcon(), {0, std::nan(""), 0.11}, q.data()));
}

/// The other way to put the device together: below its base. The arms reach there, this device not.
TEST(Delta, TheMirroredAssemblyHasNoJoints) {
  JointAngles q{};
  EXPECT_TRUE(joints_of(falcon(), {0.01, 0.02, 0.11}, q.data()));
  EXPECT_FALSE(joints_of(falcon(), {0.01, 0.02, -0.11}, q.data()));
}

TEST(Delta, EncoderCountsLeadToTheTipsOfTheReference) {
  const auto data = test::kinematics_data("falcon");
  build::ProgramSpec spec = test::spec_of(3);
  for (AxisPlan& axis : spec.axes) {
    axis.unit_per_raw = 14.25 * 2 * M_PI / (1280 * 110);
    axis.offset = 35 * M_PI / 180;
    axis.modulus_raw = 65536;
  }
  Linkage linkage{.axes = 3, .coordinates = 3, .rotary = true};
  for (std::size_t i = 0; i < 3; ++i) linkage.turn[i][i] = 1;
  spec.linkages = {linkage};
  spec.deltas = {falcon()};
  const auto read = [&](const std::array<double, 3>& counts) {
    auto rig = std::make_unique<test::Rig>(spec);
    for (std::size_t i = 0; i < 3; ++i)
      rig->samples[i].raw = counts[i] < 0 ? counts[i] + 65536 : counts[i];
    rig->again();
    return rig;
  };
  ASSERT_EQ(data["angles_from_counts"].size(), 5u);
  for (const auto& row : data["angles_from_counts"]) {
    const double counts = row["counts"];
    EXPECT_NEAR(read({counts, counts, counts})->program.state().q[1],
                row["theta_rad"].get<double>(), 1e-9);
  }
  ASSERT_EQ(data["tips_from_counts"].size(), 12u);
  for (const auto& row : data["tips_from_counts"]) {
    const auto rig = read(row["counts"]);
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_NEAR(rig->program.state().x[i], row["position_m"][i].get<double>(), 1e-9);
  }
}

TEST(Delta, JacobianIsTheDerivativeOfTheTipAllOverTheBox) {
  double worst = 0;
  const int places = all_over(kBox, [&](const Vector3d& tip, const JointAngles& q) {
    LinkagePose pose{.tip = array_of(tip)};
    ASSERT_TRUE(pose_of(falcon(), q.data(), pose));
    const auto jacobian = test::jacobian_of(pose, 3);
    const auto numerical = test::numerical_jacobian(falcon(), q, 3, pose);
    worst = std::fmax(worst, (jacobian - numerical).norm() / jacobian.norm());
  });
  EXPECT_GT(places, 1000);
  EXPECT_LT(worst, 1e-7);
}

/// The closed inverse has infinite slope where an arm is stretched, so this looks at the poses that
/// carry force.
TEST(Delta, JacobianInvertsTheDerivativeOfTheClosedInverse) {
  constexpr double kStep = 2e-7;
  double worst = 0;
  int poses = 0;
  all_over(kBox, [&](const Vector3d& tip, const JointAngles& q) {
    LinkagePose pose{.tip = array_of(tip)};
    ASSERT_TRUE(pose_of(falcon(), q.data(), pose));
    const Matrix3d jacobian = test::jacobian_of(pose, 3);
    if (jacobian.norm() * jacobian.inverse().norm() > 20) return;
    Matrix3d inverse;
    for (int k = 0; k < 3; ++k) {
      std::array<double, 3> ahead{}, behind{};
      ASSERT_TRUE(joints_of(falcon(), array_of(tip + kStep * Vector3d::Unit(k)), ahead.data()));
      ASSERT_TRUE(joints_of(falcon(), array_of(tip - kStep * Vector3d::Unit(k)), behind.data()));
      inverse.col(k) = (Vector3d(ahead.data()) - Vector3d(behind.data())) / (2 * kStep);
    }
    worst = std::fmax(worst, (jacobian * inverse - Matrix3d::Identity()).norm());
    ++poses;
  });
  EXPECT_GT(poses, 900);
  EXPECT_LT(worst, 1e-6);
}

/// A start at home has no second one to fall back on.
TEST(Delta, ForwardIsExactFromTwoMillimetresAwayAndFromHomeInTwelveSteps) {
  double worst = 0;
  const int places = all_over(kWideBox, [&](const Vector3d& tip, const JointAngles& q) {
    const Vector3d aside = Vector3d(std::sin(1e4 * tip.x()), std::cos(1e4 * tip.y()),
                                    std::sin(1e4 * (tip.x() + tip.z())))
                               .normalized();
    for (const Vector3d& start : {Vector3d(tip + 0.002 * aside), Vector3d(falcon().home.data())}) {
      LinkagePose pose{.tip = array_of(start)};
      ASSERT_TRUE(pose_of(falcon(), q.data(), pose)) << tip.transpose();
      worst = std::fmax(worst, (test::tip_of(pose) - tip).norm());
    }
  });
  EXPECT_GT(places, 1000);
  EXPECT_LT(worst, 1e-12);
}

/// A start from which Newton's steps lead to another solution of the same equations, or to none.
TEST(Delta, AWildStartFindsTheSameTip) {
  JointAngles q{};
  ASSERT_TRUE(joints_of(falcon(), {0.02, -0.01, 0.12}, q.data()));
  for (const std::array<double, 3> start :
       {std::array<double, 3>{0, 0, 0}, {0, 0, -0.12}, {0.5, 0, 0.1}, {std::nan(""), 0, 0.1}}) {
    LinkagePose pose{.tip = start};
    ASSERT_TRUE(pose_of(falcon(), q.data(), pose));
    EXPECT_NEAR((test::tip_of(pose) - Vector3d(0.02, -0.01, 0.12)).norm(), 0, 1e-12);
  }
}

TEST(Delta, NumberingTheLegsTheOtherWayRoundChangesNothing) {
  Delta other = falcon();
  std::swap(other.leg[0], other.leg[1]);
  JointAngles q{}, swapped{};
  ASSERT_TRUE(joints_of(falcon(), {0.02, -0.01, 0.12}, q.data()));
  ASSERT_TRUE(joints_of(other, {0.02, -0.01, 0.12}, swapped.data()));
  EXPECT_EQ(swapped, (JointAngles{q[1], q[0], q[2]}));
  LinkagePose pose{.tip = other.home};
  ASSERT_TRUE(pose_of(other, swapped.data(), pose));
  EXPECT_NEAR(pose.tip[2], 0.12, 1e-12);
}

TEST(Delta, ArmsThatCannotMeetHaveNoPoseAndLeaveTheLastAlone) {
  Delta wide = falcon();
  wide.r = 0.2;  // the platform is wider than arms and parallelograms reach
  LinkagePose pose{.tip = falcon().home};
  EXPECT_FALSE(pose_of(wide, JointAngles{0.3, 0.3, 0.3}.data(), pose));
  EXPECT_FALSE(pose_of(falcon(), JointAngles{0.3, std::nan(""), 0.3}.data(), pose));
  EXPECT_FALSE(pose_of(falcon(), JointAngles{0.3, HUGE_VAL, 0.3}.data(), pose));
  EXPECT_EQ(pose.tip, falcon().home);
}

/// dtheta/dp in closed form from the angles of the reference, its z column as given.
Matrix3d closed_inverse(const nlohmann::json& vector, bool as_published) {
  Matrix3d rows;
  for (int i = 0; i < 3; ++i) {
    const auto leg = static_cast<std::size_t>(i);
    const double th1 = vector["theta1_rad"][leg], th2 = vector["theta2_rad"][leg],
                 th3 = vector["theta3_rad"][leg];
    const auto [c, s] = falcon().leg[leg];
    const double den = -falcon().a * std::sin(th3) * std::sin(th1 - th2);
    const double along_z =
        as_published ? std::sin(th2) * std::sin(th2) : std::sin(th2) * std::sin(th3);
    rows.row(i) << c * std::cos(th2) * std::sin(th3) - s * std::cos(th3),
        s * std::cos(th2) * std::sin(th3) + c * std::cos(th3), along_z;
    rows.row(i) /= den;
  }
  return rows;
}

/// The Jacobian of the public drivers has sin^2(theta2) where sin(theta2) sin(theta3) belongs. At
/// (0, 0, 0.11) it renders a force along z a third too strong.
TEST(Delta, ThePublishedJacobianIsWrongAlongZ) {
  const auto data = test::kinematics_data("falcon");
  for (const auto& vector : data["poses"]) {
    LinkagePose pose{.tip = vector["position_m"]};
    ASSERT_TRUE(pose_of(falcon(), vector["theta1_rad"].get<std::array<double, 3>>().data(), pose));
    const Matrix3d jacobian = test::jacobian_of(pose, 3);
    EXPECT_LT((jacobian * closed_inverse(vector, false) - Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_GT((jacobian * closed_inverse(vector, true) - Matrix3d::Identity()).norm(), 0.05);
  }
  const Matrix3d right = closed_inverse(data["poses"][0], false).inverse();
  const Matrix3d wrong = closed_inverse(data["poses"][0], true).inverse();
  const Vector3d felt = right.transpose().inverse() * (wrong.transpose() * Vector3d::UnitZ());
  EXPECT_NEAR(felt.z(), 1.34, 0.005);
}

}  // namespace
}  // namespace hapticd::control
