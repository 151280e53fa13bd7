// The Falcon's geometry against the vectors, which were computed independently, to the tolerances that they state.
#include <cmath>
#include <numbers>

#include "control/kinematics/kinematics.h"
#include "tests/unit/usb/vectors.h"

namespace hapticd::usb {
namespace {

using control::Delta;
using control::LinkagePose;
using Point = std::array<double, 3>;

double tolerance(const char* of) {
  return vectors().at("meta").at("tolerances").at(of).get<double>();
}

/// Lengths of Novint's device; legs at 105, -15 and -135 degrees.
Delta falcon() {
  Delta delta{.a = 0.060,
              .b = 0.1025,
              .c = 0.01443,
              .d = 0.01125,
              .e = 0.01125,
              .f = -0.025,
              .r = 0.0400,
              .s = -0.02309,
              .home = {0, 0, 0.11}};
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = (105.0 - 120.0 * static_cast<double>(i)) * std::numbers::pi / 180;
    delta.leg[i] = {std::cos(angle), std::sin(angle)};
  }
  return delta;
}

/// 4 x 320 counts a turn of the motor, 14.25 mm pulley on a sector of 110 mm; at zero an arm is 35 degrees up.
double arm_angle(double counts) {
  constexpr double kCountsPerTurn = 1280.0 * 110 / 14.25, kZero_deg = 35;
  return 2 * std::numbers::pi * (counts / kCountsPerTurn + kZero_deg / 360);
}

TEST(FalconVectors, CountsAreAngles) {
  each_vector("falcon_counts_to_theta", [](const Json& vector) {
    const double angle = arm_angle(vector.at("counts").get<double>());
    EXPECT_NEAR(angle, vector.at("theta_rad").get<double>(), tolerance("theta"));
    EXPECT_NEAR(angle * 180 / std::numbers::pi, vector.at("theta_deg").get<double>(),
                60 * tolerance("theta"));
  });
}

TEST(FalconVectors, AnglesOfAPlaceAndThePlaceOfAngles) {
  each_vector("falcon_kinematics", [](const Json& vector) {
    const auto place = vector.at("position_m").get<Point>();
    const auto angles = vector.at("theta1_rad").get<Point>();
    Point found{};
    ASSERT_TRUE(control::joints_of(falcon(), place, found.data()));
    LinkagePose pose{.tip = falcon().home};
    ASSERT_TRUE(control::pose_of(falcon(), angles.data(), pose));
    for (std::size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(found[i], angles[i], tolerance("theta"));
      EXPECT_NEAR(pose.tip[i], place[i], tolerance("position_m"));
    }
  });
}

TEST(FalconVectors, JacobianAndTorques) {
  each_vector("falcon_kinematics", [](const Json& vector) {
    const auto angles = vector.at("theta1_rad").get<Point>();
    const auto jacobian = vector.at("J_dp_dtheta").get<std::array<Point, 3>>();
    const auto force = vector.at("force_N").get<Point>();
    const auto torque = vector.at("leg_torque_Nm").get<Point>();
    LinkagePose pose{.tip = falcon().home};
    ASSERT_TRUE(control::pose_of(falcon(), angles.data(), pose));
    for (std::size_t leg = 0; leg < 3; ++leg) {
      double found = 0;
      for (std::size_t row = 0; row < 3; ++row) {
        EXPECT_NEAR(pose.jacobian[row][leg], jacobian[row][leg], tolerance("J"));
        found += pose.jacobian[row][leg] * force[row];
      }
      EXPECT_NEAR(found, torque[leg], tolerance("torque"));
    }
  });
}

TEST(FalconVectors, PlacesOutOfReachHaveNoAngles) {
  each_vector("falcon_ik_unreachable", [](const Json& vector) {
    Point found{};
    EXPECT_FALSE(control::joints_of(falcon(), vector.at("position_m").get<Point>(), found.data()))
        << vector.at("why");
  });
}

TEST(FalconVectors, CountsArePlaces) {
  each_vector("falcon_fk_from_counts", [](const Json& vector) {
    const auto counts = vector.at("counts").get<Point>();
    const auto place = vector.at("position_m").get<Point>();
    const Point angles{arm_angle(counts[0]), arm_angle(counts[1]), arm_angle(counts[2])};
    LinkagePose pose{.tip = falcon().home};
    ASSERT_TRUE(control::pose_of(falcon(), angles.data(), pose));
    for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(pose.tip[i], place[i], tolerance("position_m"));
  });
}

}  // namespace
}  // namespace hapticd::usb
