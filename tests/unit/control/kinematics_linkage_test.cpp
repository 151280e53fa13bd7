// What all devices with joints share: pose in the world, reach, faults, forces to efforts and back.
#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "control/kinematics/reach.h"
#include "tests/support/linkage_fixture.h"
#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using test::JointAngles;
using test::LinkageRig;

const JointAngles kMiddle{2.25310712343, 0.8884855301596};  // tip of the five-bar at (0, 0.25)

/// Two directions, the second one `ratio` of the first.
LinearMap stretched(double ratio) {
  return {.columns = {{{1, 0}, {0, ratio}, {0, 0}}}};
}

/// kappa = c + 1/c for singular values 1 and c.
double ratio_of(double kappa) {
  return kappa / 2 - std::sqrt(kappa * kappa / 4 - 1);
}

double reach_at(double kappa) {
  LinkageRig rig(stretched(ratio_of(kappa)), {.axes = 2, .coordinates = 2});
  const Findings findings = rig.forward(JointAngles{0.1, 0.2}.data());
  EXPECT_EQ(findings.limits.has(Limit::singular), rig.reach() < 1);
  EXPECT_EQ(findings.fault.code, Fault::none);
  return rig.reach();
}

TEST(Linkage, ReachFadesFromHalfOfTheLargestConditionToNothingAtIt) {
  EXPECT_EQ(reach_at(2.5), 1);
  EXPECT_EQ(reach_at(9.999), 1);
  EXPECT_NEAR(reach_at(12.5), 0.75, 1e-12);
  EXPECT_NEAR(reach_at(15), 0.5, 1e-12);
  EXPECT_NEAR(reach_at(19.9), 0.01, 1e-12);
  EXPECT_EQ(reach_at(20.001), 0);
  EXPECT_EQ(reach_at(1e6), 0);
}

TEST(Linkage, AJacobianThatIsSingularOrNotFiniteHasNoReach) {
  const Linkage at{.axes = 3, .coordinates = 3};
  const std::array<double, 9> flat{1, 0, 1, 0, 1, 1, 0, 0, 0};
  EXPECT_EQ(reach_of(at, flat.data()), 0);
  EXPECT_EQ(reach_of(at, std::array<double, 9>{}.data()), 0);
  std::array<double, 9> good{1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(reach_of(at, good.data()), 1);
  for (const double bad : {std::nan(""), HUGE_VAL, 1e200}) {
    good[4] = bad;
    EXPECT_EQ(reach_of(at, good.data()), 0);
  }
}

/// Rounding leaves the determinant of such a J J' on either side of 0.
TEST(Linkage, RowsThatDependOnEachOtherHaveNoReach) {
  std::srand(3);
  for (std::uint16_t n = 2; n <= 3; ++n) {
    for (int i = 0; i < 1000; ++i) {
      MatrixXd jacobian = MatrixXd::Random(n, n);  // column-major, which a singular one may be
      jacobian.col(n - 1) = jacobian.leftCols(n - 1) * MatrixXd::Random(n - 1, 1);
      EXPECT_EQ(reach_of({.axes = n, .coordinates = n}, jacobian.data()), 0);
    }
  }
}

/// |J|_F |J^+|_F from the singular values.
double condition_by_svd(const MatrixXd& jacobian) {
  const Eigen::VectorXd s = Eigen::JacobiSVD<MatrixXd>(jacobian).singularValues();
  return s.norm() * s.cwiseInverse().norm();
}

TEST(Linkage, ReachIsThatOfTheSingularValuesForEveryShapeOfJacobian) {
  std::srand(1);
  for (std::uint16_t rows = 1; rows <= 3; ++rows) {
    for (std::uint16_t columns = 1; columns <= 6; ++columns) {
      for (int i = 0; i < 50; ++i) {
        using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
        const RowMajor jacobian = RowMajor::Random(rows, columns);
        const double kappa = condition_by_svd(jacobian);
        if (kappa > 1e3) continue;
        const Linkage at{
            .axes = columns, .coordinates = rows, .max_condition = kappa / 0.7};  // in the fade
        EXPECT_NEAR(reach_of(at, jacobian.data()), 0.6, 1e-9) << rows << " x " << columns;
      }
    }
  }
}

TEST(Linkage, ReachOfTheFiveBarIsThatOfTheReferencesCondition) {
  const auto reference = test::kinematics_data("five_bar");
  for (const auto& vector : reference["vectors"]) {
    const double c = vector["condJ"], kappa = c + 1 / c;
    LinkageRig rig(test::five_bar(), {.axes = 2, .coordinates = 2, .max_condition = kappa / 0.7});
    rig.forward(JointAngles{vector["theta"][0], vector["theta"][1]}.data());
    EXPECT_NEAR(rig.reach(), 0.6, 1e-9);
  }
}

TEST(Linkage, ReachOfTurningAndSlidingJointsDoesNotDependOnTheUnitOfLength) {
  const auto reach_in = [](double units_per_metre) {
    Serial chain = test::mixed_joints();
    for (DhJoint& joint : chain.joint) {
      joint.d *= units_per_metre;
      joint.a *= units_per_metre;
    }
    build::ProgramSpec spec;
    spec.axes = {{.max_effort = 2}, {.max_effort = 9}, {.max_effort = 0.5}};
    spec.axes[0].max_effort *= units_per_metre;  // N m become N mm, N stay
    spec.axes[2].max_effort *= units_per_metre;
    spec.devices = {{.axes = 3, .coordinates = 3}};
    Linkage linkage{.axes = 3, .coordinates = 3, .max_condition = 120};
    for (std::size_t i = 0; i < 3; ++i) linkage.turn[i][i] = 1;
    spec.linkages = {linkage};
    spec.serials = {chain};
    build::Program program(std::move(spec));
    for (AxisState& axis : program.state().axes) axis.seeded = axis.homed = true;
    const std::array<double, 3> q{0.3, 0.05 * units_per_metre, -0.4};
    std::copy(q.begin(), q.end(), program.state().q.begin());
    Findings findings;
    forward(program.plan(), program.state(), findings);
    return program.state().reach[0];
  };
  const double metres = reach_in(1);
  EXPECT_GT(metres, 0.05) << "in the fade, where the reach shows the condition";
  EXPECT_LT(metres, 0.95);
  EXPECT_NEAR(reach_in(1000), metres, 1e-12);
}

TEST(Linkage, TipAndJacobianAreTurnedScaledAndMovedIntoTheWorld) {
  const Matrix3d turn =
      2.5 * Eigen::Quaterniond(0.5, -0.3, 0.7, 0.2).normalized().toRotationMatrix();
  const Vector3d origin(0.1, -0.2, 0.3);
  LinkageRig rig(test::falcon(), {.axes = 3, .coordinates = 3, .turn = turn, .origin = origin});
  JointAngles q{};
  ASSERT_TRUE(joints_of(test::falcon(), {0.02, -0.01, 0.12}, q.data()));
  const Vector3d qd(0.3, -2, 1);
  rig.forward(q.data(), qd.data());
  LinkagePose pose{.tip = test::falcon().home};
  ASSERT_TRUE(pose_of(test::falcon(), q.data(), pose));
  const Vector3d x = origin + turn * Vector3d(0.02, -0.01, 0.12);
  const Matrix3d jacobian = turn * test::jacobian_of(pose, 3);
  const Vector3d v = jacobian * qd;
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(rig.state().x[1 + i], x[static_cast<int>(i)], 1e-14);
    EXPECT_NEAR(rig.state().v[1 + i], v[static_cast<int>(i)], 1e-14);
    for (std::size_t j = 0; j < 3; ++j)
      EXPECT_NEAR(rig.state().jacobian[3 * i + j],
                  jacobian(static_cast<int>(i), static_cast<int>(j)), 1e-14);
  }
}

TEST(Linkage, JointsThatFitNoPoseKeepTheLastOneAtRestAndAreAFault) {
  LinkageRig rig(test::five_bar(), {.axes = 2, .coordinates = 2});
  const JointAngles qd{1, 2};
  ASSERT_EQ(rig.forward(kMiddle.data(), qd.data()).fault.code, Fault::none);
  ASSERT_NE(rig.state().v[2], 0);
  EXPECT_NEAR(rig.state().x[2], 0.25, 1e-12);
  EXPECT_EQ(rig.reach(), 1);
  const std::vector<double> jacobian(rig.state().jacobian.begin(), rig.state().jacobian.end());
  const Findings findings = rig.forward(JointAngles{M_PI, 0}.data(), qd.data());
  EXPECT_EQ(findings.fault.code, Fault::kinematics);
  EXPECT_EQ(findings.fault.device, 1);
  EXPECT_TRUE(findings.limits.has(Limit::singular));
  EXPECT_EQ(rig.reach(), 0);
  EXPECT_NEAR(rig.state().x[2], 0.25, 1e-12);
  EXPECT_EQ(rig.state().v[1], 0);
  EXPECT_EQ(rig.state().v[2], 0);
  EXPECT_EQ(std::vector<double>(rig.state().jacobian.begin(), rig.state().jacobian.end()),
            jacobian);
  rig.forward(kMiddle.data());
  EXPECT_EQ(rig.reach(), 1) << "and it goes on where a pose fits again";
}

TEST(Linkage, AnAxisWithoutASampleIsNoFaultAndHasNoReach) {
  LinkageRig rig(test::five_bar(), {.axes = 2, .coordinates = 2});
  rig.state().axes[2].seeded = false;
  const Findings findings = rig.forward(JointAngles{M_PI, 0}.data());
  EXPECT_EQ(findings.fault.code, Fault::none);
  EXPECT_FALSE(findings.limits.has(Limit::singular));
  EXPECT_EQ(rig.reach(), 0);
}

TEST(Linkage, BeforeHomingAPoseIsTriedButItsAbsenceIsNoFault) {
  LinkageRig rig(test::five_bar(), {.axes = 2, .coordinates = 2});
  rig.state().axes[1].homed = false;
  EXPECT_EQ(rig.forward(JointAngles{M_PI, 0}.data()).fault.code, Fault::none);
  EXPECT_EQ(rig.reach(), 0);
  rig.forward(kMiddle.data());
  EXPECT_NEAR(rig.state().x[2], 0.25, 1e-12);
  EXPECT_EQ(rig.reach(), 1);
}

TEST(Linkage, TheDeltaFindsItsFirstPoseFromHome) {
  LinkageRig rig(test::falcon(), {.axes = 3, .coordinates = 3});
  JointAngles q{};
  ASSERT_TRUE(joints_of(test::falcon(), {-0.03, 0.02, 0.1}, q.data()));
  EXPECT_EQ(rig.forward(q.data()).fault.code, Fault::none);
  EXPECT_NEAR(rig.state().x[1], -0.03, 1e-12);
  EXPECT_NEAR(rig.state().x[3], 0.1, 1e-12);
  EXPECT_NEAR(rig.state().linkages[0].tip[0], -0.03, 1e-12) << "where the next solution starts";
}

/// A device of one, two or three axes along random directions: contact_force undoes transpose.
TEST(Linkage, ContactForceUndoesTranspose) {
  std::srand(2);
  for (std::uint16_t n = 1; n <= 3; ++n) {
    for (int i = 0; i < 200; ++i) {
      LinearMap map;
      const Matrix3d columns = Matrix3d::Random();
      const double condition = condition_by_svd(columns.topLeftCorner(n, n));
      for (std::size_t r = 0; r < n; ++r) {
        for (std::size_t c = 0; c < n; ++c)
          map.columns[r][c] = columns(static_cast<int>(r), static_cast<int>(c));
      }
      LinkageRig rig(map, {.axes = n, .coordinates = n});
      rig.forward(JointAngles{0.1, 0.2, 0.3}.data());
      const std::array<double, 4> force{7, 1, -2, 3};
      std::array<double, 4> effort{};
      transpose(rig.plan(), rig.state(), force, effort);
      EXPECT_EQ(effort[0], 7) << "the Cartesian device beside it";
      std::array<double, 3> back{};
      ASSERT_TRUE(contact_force(rig.plan(), rig.state(), 1, &effort[1], back.data()));
      for (std::size_t k = 0; k < n; ++k) EXPECT_NEAR(back[k], force[1 + k], 1e-14 * condition);
    }
  }
}

TEST(Linkage, ContactForceOfAJacobianThatIsFlatOrNotSquareIsUnknown) {
  double force[3] = {7, 7, 7};
  const double effort[6] = {1, 1, 1, 1, 1, 1};
  LinkageRig flat(stretched(1e-300), {.axes = 2, .coordinates = 2});
  EXPECT_FALSE(contact_force(flat.plan(), flat.state(), 1, effort, force)) << "no pose yet";
  flat.forward(JointAngles{}.data());
  EXPECT_TRUE(contact_force(flat.plan(), flat.state(), 1, effort, force)) << "small is not flat";
  LinearMap parallel{.columns = {{{1, 2}, {1, 2 + 1e-12}, {0, 0}}}};
  LinkageRig line(parallel, {.axes = 2, .coordinates = 2});
  line.forward(JointAngles{}.data());
  EXPECT_FALSE(contact_force(line.plan(), line.state(), 1, effort, force));
  LinkageRig wide(test::six_joints(), {.axes = 6, .coordinates = 3});
  wide.forward(JointAngles{0.1, 0.2, 0.3, 0.4, 0.5, 0.6}.data());
  EXPECT_FALSE(contact_force(wide.plan(), wide.state(), 1, effort, force));
}

TEST(CartesianAxes, ContactForceUndoesTransposeWithScaleAndSign) {
  auto spec = test::spec_of(3);
  spec.cartesian_axes = {{.axis = 2, .coordinate = 0, .scale = -2.5},
                         {.axis = 0, .coordinate = 1, .scale = 0.4},
                         {.axis = 1, .coordinate = 2, .scale = 1}};
  build::Program program(std::move(spec));
  const std::array<double, 3> force{1, -2, 3};
  std::array<double, 3> effort{}, back{};
  transpose(program.plan(), program.state(), force, effort);
  EXPECT_EQ(effort, (std::array<double, 3>{-0.8, 3, -2.5}));
  ASSERT_TRUE(contact_force(program.plan(), program.state(), 0, effort.data(), back.data()));
  EXPECT_EQ(back, force);
}

/// An axis that the map does not have is not read.
TEST(LinearMap, TipIsTheSumOfTheAxesAlongTheirDirections) {
  const LinearMap map{.columns = {{{0.6, -0.8}, {0.8, 0.6}, {0, 0}}}};
  LinkagePose pose;
  JointAngles q{1, 2, std::nan("")};
  ASSERT_TRUE(pose_of(map, q.data(), pose));
  EXPECT_NEAR(pose.tip[0], -1, 1e-15);
  EXPECT_NEAR(pose.tip[1], 2, 1e-15);
  EXPECT_EQ(pose.tip[2], 0);
  EXPECT_EQ(pose.jacobian, map.columns);
  q[1] = std::nan("");
  EXPECT_FALSE(pose_of(map, q.data(), pose));
}

}  // namespace
}  // namespace hapticd::control
