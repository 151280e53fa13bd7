// Reference: Eigen's quaternions, and turns about a fixed axis in closed form.
#include "control/scene/path.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numbers>
#include <random>
#include <vector>

namespace hapticd::control {
namespace {

constexpr double kPi = std::numbers::pi;

std::array<double, 4> about_z(double angle) {
  return {std::cos(angle / 2), 0, 0, std::sin(angle / 2)};
}

double angle_about_z(const Frame& frame) {
  return std::atan2(frame.turn.row[1].x, frame.turn.row[0].x);
}

/// 0.1 m along x in the first second, a quarter turn in the second.
const std::vector<Waypoint> kWay{
    {.at_s = 0, .position = {0, 0, 0}},
    {.at_s = 1, .position = {0.1, 0, 0}},
    {.at_s = 2, .position = {0.1, 0, 0}, .turn = about_z(kPi / 2)},
};

TEST(Path, IsStraightBetweenWaypointsAndTurnsSteadily) {
  const Path path{.first = 0, .count = 3};
  EXPECT_NEAR(pose_at(path, kWay, 0.25).at.x, 0.025, 1e-17);
  EXPECT_EQ(pose_at(path, kWay, 0.25).turn, diagonal(1));
  EXPECT_EQ(pose_at(path, kWay, 1.5).at, (Vec3{0.1, 0, 0}));
  for (double s = 0; s < 1; s += 0.01)
    EXPECT_NEAR(angle_about_z(pose_at(path, kWay, 1 + s)), s * kPi / 2, 1e-15);
}

TEST(Path, StandsStillBeforeTheFirstAndAfterTheLastWaypoint) {
  const std::vector<Waypoint> late{{.at_s = 1, .position = {1, 0, 0}},
                                   {.at_s = 2, .position = {2, 0, 0}}};
  const Path path{.first = 0, .count = 2};
  EXPECT_EQ(pose_at(path, late, 0).at.x, 1);
  EXPECT_EQ(pose_at(path, late, 2).at.x, 2);
  EXPECT_EQ(pose_at(path, late, 1e9).at.x, 2);
  EXPECT_EQ(pose_at({.first = 1, .count = 1}, late, 0.5).at.x, 2) << "a single waypoint";
}

TEST(Path, BeginsAnewWhereItRepeats) {
  const Path path{.first = 0, .count = 3, .repeat = true};
  EXPECT_EQ(pose_at(path, kWay, 2), pose_at(path, kWay, 0));
  EXPECT_EQ(pose_at(path, kWay, 2e6 + 0.25), pose_at(path, kWay, 0.25));
  EXPECT_EQ(pose_at({.first = 0, .count = 1, .repeat = true}, kWay, 5).at.x, 0);
}

TEST(Path, IsOnlyItsOwnPartOfTheWaypoints) {
  const std::vector<Waypoint> two{{.at_s = 0, .position = {9, 9, 9}},
                                  {.at_s = 0, .position = {1, 0, 0}},
                                  {.at_s = 4, .position = {5, 0, 0}},
                                  {.at_s = 0, .position = {8, 8, 8}}};
  EXPECT_EQ(pose_at({.first = 1, .count = 2}, two, 3).at.x, 4);
  EXPECT_EQ(pose_at({.first = 1, .count = 2}, two, 99).at.x, 5);
}

TEST(Path, TurnsAlongTheShortestArcWhicheverSignAQuaternionHas) {
  std::vector<Waypoint> way{{.at_s = 0, .turn = about_z(0.1)}, {.at_s = 1, .turn = about_z(0.5)}};
  for (const double sign : {1.0, -1.0}) {
    for (double& part : way[1].turn) part *= sign;
    EXPECT_NEAR(angle_about_z(pose_at({.count = 2}, way, 0.25)), 0.2, 1e-15);
  }
  const std::vector<Waypoint> same{{.at_s = 0, .turn = {1, 0, 0, 0}},
                                   {.at_s = 1, .turn = {-1, 0, 0, 0}}};
  EXPECT_EQ(pose_at({.count = 2}, same, 0.5).turn, diagonal(1));
  way[1].turn = about_z(0.1 + 1.5 * kPi);  // shorter the other way round
  EXPECT_NEAR(angle_about_z(pose_at({.count = 2}, way, 0.5)), 0.1 - 0.25 * kPi, 1e-15);
}

TEST(Path, TurnsAsEigensQuaternionsDoAndStaysARotation) {
  std::mt19937 random(5);
  std::normal_distribution<double> number;
  for (int n = 0; n < 300; ++n) {
    const double apart = std::pow(10, -(n % 17));  // from anywhere down to rounding
    const Eigen::Quaterniond a =
        Eigen::Quaterniond(number(random), number(random), number(random), number(random))
            .normalized();
    const Eigen::Vector3d axis = Eigen::Vector3d(number(random), number(random), 1).normalized();
    const Eigen::Quaterniond b = a * Eigen::AngleAxisd(3 * apart, axis);
    const std::vector<Waypoint> way{{.at_s = 0, .turn = {a.w(), a.x(), a.y(), a.z()}},
                                    {.at_s = 1, .turn = {b.w(), b.x(), b.y(), b.z()}}};
    const Eigen::Matrix3d expected = (a * Eigen::AngleAxisd(0.9 * apart, axis)).toRotationMatrix();
    const Frame frame = pose_at({.count = 2}, way, 0.3);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t j = 0; j < 3; ++j)
        EXPECT_NEAR(frame.turn.row[i][j],
                    expected(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)), 2e-15);
  }
}

/// No step is larger than the speed allows, at waypoints neither.
TEST(Path, MovesContinuously) {
  const std::vector<Waypoint> way{{.at_s = 0},
                                  {.at_s = 0.3, .position = {0.1, 0, 0}, .turn = about_z(3)},
                                  {.at_s = 0.31, .position = {0.1, 0.01, 0}, .turn = about_z(3.05)},
                                  {.at_s = 1, .position = {0, 0, 0}, .turn = about_z(6)}};
  Frame before = pose_at({.count = 4}, way, 0);
  for (int i = 1; i < 12000; ++i) {
    const Frame now = pose_at({.count = 4}, way, i * 1e-4);
    ASSERT_LT(norm(now.at - before.at), 1e-4 * 1.01) << i;
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_LT(norm(now.turn.row[k] - before.turn.row[k]), 1e-4 * 10.1) << i;
    before = now;
  }
}

}  // namespace
}  // namespace hapticd::control
