// Bounds over all poses, against dense samples of the loop's own kinematics and closed forms.
#include "control/design/check/poses.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "control/core/algebra.h"
#include "control/design/check/stability.h"
#include "control/kinematics/reach.h"
#include "tests/support/couplings.h"
#include "tests/support/linkage_fixture.h"

namespace hapticd::check {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// One linkage in a plan; tip coordinates are the world's.
template <class Kind>
build::ProgramSpec spec_of(const Kind& kind, std::uint16_t axes, std::uint16_t coordinates,
                           double max_velocity) {
  build::ProgramSpec spec;
  spec.axes.assign(axes, {.max_effort = 1, .max_velocity = max_velocity, .max_step = 1});
  spec.devices = {{.axes = axes, .coordinates = coordinates, .max_force = 10}};
  control::Linkage linkage{.axes = axes, .coordinates = coordinates, .rotary = true};
  linkage.turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  spec.linkages = {linkage};
  if constexpr (std::is_same_v<Kind, control::FiveBar>) spec.five_bars = {kind};
  if constexpr (std::is_same_v<Kind, control::Delta>) spec.deltas = {kind};
  if constexpr (std::is_same_v<Kind, control::Serial>) spec.serials = {kind};
  return spec;
}

/// Share that springs and dampers ask at one pose.
double share_at(const MatrixXd& jacobian, const VectorXd& damping, const MatrixXd& weight) {
  const MatrixXd spread = damping.cwiseSqrt().cwiseInverse().asDiagonal();
  return algebra::symmetric_eigenvalues(spread * jacobian.transpose() * weight * jacobian * spread)
      .maxCoeff();
}

TEST(Poses, OneTurningLinkIsItsClosedForm) {
  control::Serial chain{.joints = 1, .joint = {test::revolute(0, 0, 0.2, 0)}};
  auto spec = spec_of(chain, 1, 2, 0);
  const build::Program program(std::move(spec));
  const VectorXd damping = VectorXd::Constant(1, 0.1);
  const PoseAnswer answer = largest_share(
      program.plan(), 0, damping, {.weight = 0.5 * MatrixXd::Identity(2, 2), .bending_force = 5});
  // J'J = l^2 everywhere, |d2x/dq2| = l: 0.5 * 0.04 + 0.5e-3 * 5 * 0.2 N m s.
  EXPECT_GE(answer.share, (0.02 + 5e-4) / 0.1 * (1 - 1e-12));
  EXPECT_LE(answer.share, (0.02 * 1.03 + 5e-4) / 0.1);
  EXPECT_NEAR(answer.found, 0.2, 1e-9);
  EXPECT_NEAR(answer.bending, 5e-3, 1e-8);
}

TEST(Poses, FiveBarInABoxIsBoundedByWhatDenseSamplesFind) {
  const control::FiveBar bars = test::five_bar();
  auto spec = spec_of(bars, 2, 2, 2);
  spec.workspaces = {{.device = 0, .min = {-0.06, 0.2, 0}, .max = {0.06, 0.3, 0}}};
  const build::Program program(std::move(spec));
  VectorXd damping(2);
  damping << 0.02, 0.03;
  MatrixXd weight(2, 2);
  weight << 0.4, 0.1, 0.1, 0.7;
  const PoseAnswer answer =
      largest_share(program.plan(), 0, damping, {.weight = weight, .bending_force = 5});
  // All poses of the loop's own kinematics that no guard limits, elbows in or out.
  double most = 0, bend = 0;
  int seen = 0;
  for (double q1 = -M_PI; q1 < M_PI; q1 += 0.02) {
    for (double q2 = -M_PI; q2 < M_PI; q2 += 0.02) {
      const double q[2] = {q1, q2};
      control::LinkagePose pose;
      if (!control::pose_of(bars, q, pose)) continue;
      if (std::abs(pose.tip[0]) > 0.06 || pose.tip[1] < 0.2 || pose.tip[1] > 0.3) continue;
      const MatrixXd j = test::jacobian_of(pose, 2).topRows(2);
      const Eigen::Matrix<double, 2, 2, Eigen::RowMajor> rows = j;
      if (control::reach_of(program.plan().linkages[0], rows.data()) < 1) continue;
      ++seen;
      const double share = share_at(j, damping, weight);
      if (share < most) continue;
      most = share;
      bend = 0;  // second differences along directions of scaled joints, there
      for (double angle = 0; angle < M_PI; angle += 0.2) {
        const double h = 1e-4;
        const Eigen::Vector2d v(std::cos(angle) / std::sqrt(damping[0]),
                                std::sin(angle) / std::sqrt(damping[1]));
        const auto tip = [&](double way) {
          const double at[2] = {q1 + way * v[0], q2 + way * v[1]};
          control::LinkagePose there;
          EXPECT_TRUE(control::pose_of(bars, at, there));
          return Eigen::Vector3d(there.tip.data());
        };
        bend = std::max(bend, 0.5e-3 * 5 * (tip(h) - 2 * tip(0) + tip(-h)).norm() / (h * h));
      }
    }
  }
  EXPECT_GT(seen, 100);
  EXPECT_TRUE(answer.met);
  EXPECT_GE(answer.share, most + bend * 0.99);
  EXPECT_LE(answer.share - answer.bending, 1.1 * answer.found);
  EXPECT_GE(answer.found, 0.98 * most);
  EXPECT_GE(answer.bending, bend * 0.99);
}

TEST(Poses, DeltaInABoxIsBoundedByWhatDenseSamplesFind) {
  const control::Delta legs = test::falcon();
  auto spec = spec_of(legs, 3, 3, 1);
  spec.workspaces = {{.device = 0, .min = {-0.02, -0.02, 0.1}, .max = {0.02, 0.02, 0.13}}};
  const build::Program program(std::move(spec));
  const VectorXd damping = VectorXd::Constant(3, 0.003);
  const MatrixXd weight = 0.3 * MatrixXd::Identity(3, 3);
  const PoseAnswer answer =
      largest_share(program.plan(), 0, damping, {.weight = weight, .bending_force = 5});
  double most = 0;
  for (double x = -0.02; x <= 0.0201; x += 0.005) {
    for (double y = -0.02; y <= 0.0201; y += 0.005) {
      for (double z = 0.1; z <= 0.1301; z += 0.005) {
        test::JointAngles q{};
        ASSERT_TRUE(control::joints_of(legs, {x, y, z}, q.data()));
        control::LinkagePose pose{.tip = {x, y, z}};
        ASSERT_TRUE(control::pose_of(legs, q.data(), pose));
        most = std::max(most, share_at(test::jacobian_of(pose, 3), damping, weight));
      }
    }
  }
  EXPECT_GE(answer.share, most);
  EXPECT_LE(answer.share - answer.bending, 1.2 * most);
  EXPECT_NEAR(answer.found, most, 0.1 * most);
}

/// Largest share and largest bending over a grid of joint positions inside the travels.
struct Densely {
  double share = 0, bending = 0;
};
Densely densely(const control::Serial& chain, const build::ProgramSpec& spec,
                const VectorXd& damping, const MatrixXd& weight, double force) {
  constexpr int kSteps = 12;
  Densely most;
  const auto n = static_cast<Eigen::Index>(chain.joints);
  std::array<int, 3> at{};
  const auto tip = [&](const VectorXd& q) {
    control::LinkagePose pose;
    EXPECT_TRUE(control::pose_of(chain, q.data(), pose));
    return Eigen::Vector3d(pose.tip.data());
  };
  for (at[0] = 0; at[0] <= kSteps; ++at[0]) {
    for (at[1] = 0; at[1] <= kSteps; ++at[1]) {
      for (at[2] = 0; at[2] <= kSteps; ++at[2]) {
        VectorXd q(n);
        for (Eigen::Index i = 0; i < n; ++i) {
          const control::TravelPlan& travel = spec.travels[static_cast<std::size_t>(i)];
          q[i] = travel.min + (travel.max - travel.min) * at[static_cast<std::size_t>(i)] / kSteps;
        }
        control::LinkagePose pose;
        EXPECT_TRUE(control::pose_of(chain, q.data(), pose));
        most.share = std::max(most.share, share_at(test::jacobian_of(pose, 3), damping, weight));
        // Second differences along random directions of scaled joints, by a fixed pattern.
        for (int turn = 0; turn < 6; ++turn) {
          VectorXd v(n);
          for (Eigen::Index i = 0; i < n; ++i)
            v[i] = std::sin(1.7 * turn + 2.3 * static_cast<double>(i));
          v = (v.normalized().array() / damping.array().sqrt()).matrix();
          const double h = 1e-4 / v.norm();
          const double bend = (tip(q + h * v) - 2 * tip(q) + tip(q - h * v)).norm() / (h * h);
          most.bending = std::max(most.bending, 0.5e-3 * force * bend);
        }
      }
    }
  }
  return most;
}

TEST(Poses, AChainThatSlidesAndTurnsIsBoundedByWhatDenseSamplesFind) {
  const control::Serial chain = test::mixed_joints();
  auto spec = spec_of(chain, 3, 3, 0);
  spec.travels = {{.axis = 0, .min = -1, .max = 1, .margin = 1e-6},
                  {.axis = 1, .min = 0.1, .max = 0.4, .margin = 1e-6},
                  {.axis = 2, .min = -1.5, .max = 1.5, .margin = 1e-6}};
  VectorXd damping(3);
  damping << 0.5, 3, 0.4;
  MatrixXd weight(3, 3);
  weight << 0.5, 0.1, 0, 0.1, 0.6, -0.1, 0, -0.1, 0.4;
  constexpr double kForce = 40;
  const Densely most = densely(chain, spec, damping, weight, kForce);
  const build::Program program(std::move(spec));
  const PoseAnswer answer =
      largest_share(program.plan(), 0, damping, {.weight = weight, .bending_force = kForce});
  ASSERT_EQ(answer.problem, "");
  EXPECT_TRUE(answer.met);
  EXPECT_GE(answer.share - answer.bending, most.share);
  EXPECT_GE(answer.bending, most.bending);
  EXPECT_LE(answer.share - answer.bending, 1.3 * most.share);
}

TEST(Poses, ALinkageAndTwoMoreThatACouplingTiesBearEveryMixedSpringOnce) {
  auto spec = spec_of(test::five_bar(), 2, 2, 2);
  spec.workspaces = {{.device = 0, .min = {-0.06, 0.2, 0}, .max = {0.06, 0.3, 0}}};
  spec.contacts = {{.device = 0, .coordinates = 2, .direction = {0, 1, 2}, .max_force = 10}};
  for (std::uint16_t d = 1; d <= 2; ++d) {
    const auto at = static_cast<std::uint16_t>(d + 1);
    spec.devices.push_back(
        {.first_axis = at, .axes = 1, .first_coordinate = at, .coordinates = 1, .max_force = 10});
    spec.axes.push_back({.max_effort = 1, .max_velocity = 1, .max_step = 1});
    spec.contacts.push_back(
        {.device = d, .first_coordinate = at, .coordinates = 1, .max_force = 10});
  }
  spec.device_names = {"bars", "b", "c"};
  spec.axis_names = spec.coordinate_names = {"bars.x", "bars.y", "b", "c"};
  spec.coupling = {test::springs(
      {0, 1, 2, 3},
      test::matrix({{100, 0, 10, 20}, {0, 100, -30, 5}, {10, -30, 200, 40}, {20, 5, 40, 300}}),
      test::matrix({{0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}))};
  const build::Program program(std::move(spec));
  const auto answers = passive(program.plan(), {{.name = "bars", .min_damping = {9, 9}},
                                                {.name = "b", .min_damping = {0.2}},
                                                {.name = "c", .min_damping = {9}}});
  // b: 200 of its own, |10| + |-30| + |40| with others.
  EXPECT_TRUE(answers[0].proved) << answers[0].why;
  EXPECT_NEAR(answers[0].damping_used, 0.5e-3 * 280 / 0.2, 1e-9);
}

TEST(Poses, ASlidingJointWithoutLimitsIsNotDecided) {
  control::Serial chain = test::mixed_joints();
  auto spec = spec_of(chain, 3, 3, 1);
  const build::Program program(std::move(spec));
  const PoseAnswer answer = largest_share(program.plan(), 0, VectorXd::Ones(3),
                                          {.weight = MatrixXd::Identity(3, 3), .bending_force = 1});
  EXPECT_NE(answer.problem.find("travel"), std::string::npos);
}

}  // namespace
}  // namespace hapticd::check
