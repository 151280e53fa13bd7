// The shipped examples are sound, and say what they claim.
#include <Eigen/Dense>
#include <cmath>
#include <filesystem>

#include "control/kinematics/kinematics.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

TEST(Examples, EveryOneCompiles) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("config/examples"))) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    EXPECT_TRUE(load(entry.path().string())) << entry.path();
  }
  EXPECT_GE(count, 18);
}

TEST(Examples, WallMeetsItsOwnInequality) {
  const Compiled wall = example("wall.yaml");
  const control::PlaneContact& plane = wall.program->plan().planes[0];
  EXPECT_LT(plane.stiffness * 0.001 / 2 + plane.damping, wall.assumed[0].min_damping[0]);
  EXPECT_EQ(wall.document.config.stability.require, Require::passive);
  EXPECT_EQ(wall.document.config.start.enable, EnableWhen::when_ready);
}

TEST(Examples, WallIsPushedAfterTheRampFromTheFreeSide) {
  const Compiled wall = example("wall.yaml");
  const control::PlaneContact& plane = wall.program->plan().planes[0];
  EXPECT_GT(plane.normal[0] * wall.simulated[0].axes[0].position_m, plane.offset);
  double push_N = 0;
  for (const sim::ScriptStep& step : wall.simulated[0].hand.script)
    push_N = std::min(push_N, step.force_N * plane.normal[0]);
  EXPECT_LT(push_N, 0) << "against the normal";
  EXPECT_EQ(wall.simulated[0].ramp_s, 0.5);
}

TEST(Examples, TwoDevicesHaveDifferentLimits) {
  const Compiled two = example("two_devices.yaml");
  const auto devices = two.program->plan().devices;
  ASSERT_EQ(devices.size(), 2U);
  EXPECT_EQ(devices[0].axes, 3);
  EXPECT_EQ(devices[1].axes, 1);
  EXPECT_NE(devices[0].max_force, devices[1].max_force);
  EXPECT_EQ(two.program->plan().planes.size(), 2U);
}

TEST(Examples, PaperTwoHasThePapersFigures) {
  const Compiled paper = example("paper2_wall.yaml");
  const sim::DeviceOptions& device = paper.simulated[0];
  EXPECT_EQ(device.axes[0].mass_kg, 0.01);
  EXPECT_EQ(device.axes[0].damping_Ns_m, 0.022);
  EXPECT_EQ(device.axes[0].counts_per_m, 1e9);
  EXPECT_EQ(device.axes[0].position_m, 0);
  EXPECT_EQ(device.hand.mass_kg, 0);
  ASSERT_EQ(device.hand.script.size(), 1U);
  EXPECT_EQ(device.hand.script[0].force_N, -5);
  const control::PlaneContact& plane = paper.program->plan().planes[0];
  EXPECT_EQ(plane.stiffness, 1000);
  EXPECT_EQ(plane.damping, 1);
  EXPECT_EQ(plane.offset, 0);
  EXPECT_EQ(paper.program->plan().devices[0].max_force, 30);
  EXPECT_EQ(paper.document.config.stability.require, Require::none);
}

TEST(Examples, FiveBarIsThePapersAndStartsAboveItsFloor) {
  const Compiled arm = example("five_bar.yaml");
  const control::FiveBar& bars = arm.program->plan().five_bars[0];
  EXPECT_EQ(bars.link_m, 0.2);
  EXPECT_EQ(bars.base_m, 0.1);
  const sim::DeviceOptions& device = arm.simulated[0];
  EXPECT_EQ(device.axes[0].mass_kg, 1e-5);
  EXPECT_EQ(device.axes[0].damping_Ns_m, 8e-4);
  EXPECT_EQ(device.axes[0].coulomb_N, 2e-3);
  EXPECT_EQ(device.linkage->inner_link_kg, 0.010);
  EXPECT_EQ(device.linkage->outer_link_kg, 0.006);
  EXPECT_EQ(device.linkage->tip_kg, 0.003);
  const std::array<double, 2> q{device.axes[0].position_m, device.axes[1].position_m};
  control::LinkagePose pose;
  ASSERT_TRUE(control::pose_of(bars, q.data(), pose));
  EXPECT_NEAR(pose.tip[0], 0, 1e-9);
  EXPECT_NEAR(pose.tip[1], 0.25, 1e-9);
  EXPECT_LT(arm.program->plan().planes[0].offset, 0.25);
}

/// The contact of the first device where its simulation starts.
std::array<double, 3> start_of(const Compiled& compiled) {
  const control::Plan& plan = compiled.program->plan();
  std::array<double, 3> q{};
  for (std::size_t i = 0; i < q.size(); ++i) q[i] = compiled.simulated[0].axes[i].position_m;
  control::LinkagePose pose;
  pose.tip = plan.deltas[0].home;
  EXPECT_TRUE(control::pose_of(plan.deltas[0], q.data(), pose));
  std::array<double, 3> x = plan.linkages[0].origin;
  for (std::size_t i = 0; i < x.size(); ++i) {
    for (std::size_t j = 0; j < x.size(); ++j) x[i] += plan.linkages[0].turn[i][j] * pose.tip[j];
  }
  return x;
}

TEST(Examples, FalconStartsAtTheWorldsOriginAboveItsFloor) {
  const Compiled falcon = example("falcon_sim.yaml");
  const std::array<double, 3> x = start_of(falcon);
  for (const double coordinate : x) EXPECT_NEAR(coordinate, 0, 1e-8);
  const control::PlaneContact& floor = falcon.program->plan().planes[0];
  EXPECT_EQ(floor.normal[2], 1);
  EXPECT_LT(floor.offset, 0);
}

TEST(Examples, FalconsWeightIsHeldAgainstTheGravityOfItsSimulation) {
  const Compiled falcon = example("falcon_sim.yaml");
  const control::Linkage& linkage = falcon.program->plan().linkages[0];
  const sim::LinkageOptions& truth = *falcon.simulated[0].linkage;
  for (std::size_t i = 0; i < 3; ++i) {
    double weight = 0;
    for (std::size_t j = 0; j < 3; ++j) weight += linkage.turn[i][j] * truth.gravity[j];
    EXPECT_DOUBLE_EQ(falcon.program->plan().gravity_tips[0].weight[i], -truth.tip_kg * weight);
  }
}

TEST(Examples, ObserversTruthIsWithinTheBoxOfItsModel) {
  const Compiled slide = example("observer.yaml");
  const AxisModel& model = *slide.document.config.devices[0].axes[0].model;
  const sim::AxisOptions& truth = slide.simulated[0].axes[0];
  EXPECT_NE(truth.mass_kg, *model.mass_kg);
  EXPECT_LE(std::abs(truth.mass_kg / *model.mass_kg - 1), model.mass_uncertainty);
  EXPECT_LE(std::abs(truth.damping_Ns_m / *model.damping_Ns_m - 1), model.damping_uncertainty);
  EXPECT_EQ(slide.program->plan().axis_observers.size(), 1U);
  EXPECT_EQ(slide.program->plan().frictions.size(), 1U);
}

TEST(Examples, HomingMeetsItsOwnInequality) {
  const Compiled slide = example("homing.yaml");
  const control::Plan& plan = slide.program->plan();
  EXPECT_LT(
      (plan.planes[0].stiffness + plan.travels[0].stiffness) * 0.001 / 2 + plan.planes[0].damping,
      slide.assumed[0].min_damping[0]);
  EXPECT_TRUE(slide.assumed[0].obstacles.empty());
}

TEST(Examples, HomingFindsTheStopThatTheSimulationHas) {
  const Compiled slide = example("homing.yaml");
  const sim::AxisOptions& axis = slide.simulated[0].axes[0];
  const control::HomingPlan& homing = slide.program->plan().homings[0];
  EXPECT_TRUE(axis.relative);
  EXPECT_LT(homing.effort, 0);
  EXPECT_EQ(homing.position, axis.stops->min_m);
  std::uint32_t wanted = 0;
  for (const control::EnableInput& input : slide.program->plan().enable_inputs)
    wanted |= input.active;
  EXPECT_EQ(slide.simulated[0].digital.front().bits, wanted);
}

TEST(Examples, PaperOneIsItsStarThroughItsCoupling) {
  const Compiled compiled = example("paper1_example1.yaml");
  const build::ProgramSpec& spec = compiled.program->spec();
  ASSERT_EQ(spec.coupling.size(), 3U);
  const std::array<double, 3> stiffness{704.9058, 704.9336, 704.8754};  // (26)
  for (std::size_t i = 0; i < stiffness.size(); ++i) {
    EXPECT_EQ(spec.coupling[i].stiffness.values, (std::vector<double>{stiffness[i]}));
    EXPECT_EQ(spec.coupling[i].damping.values, (std::vector<double>{0.0372}));
  }
  ASSERT_EQ(spec.networks.size(), 1U);
  EXPECT_EQ(spec.networks[0].nodes.at(0).mass, 3);
  const std::array<std::pair<double, double>, 4> springs{
      {{2600, 0.5}, {3800, 0.1}, {3500, 0.2}, {3300, 0.3}}};
  ASSERT_EQ(spec.networks[0].elements.size(), springs.size());
  for (std::size_t i = 0; i < springs.size(); ++i) {
    EXPECT_EQ(spec.networks[0].elements[i].stiffness, springs[i].first);
    EXPECT_EQ(spec.networks[0].elements[i].damping, springs[i].second);
  }
}

TEST(Examples, PaperOnesHandIsThePapersTransferFunction) {
  const Compiled paper = example("paper1_example1.yaml");
  const sim::SharedHandOptions& hand = *paper.shared_hand;
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto n = static_cast<Eigen::Index>(hand.states);
  const Eigen::Map<const ByRows> A(hand.A.data(), n, n), B(hand.B.data(), n, 3),
      C(hand.C.data(), 3, n), D(hand.D.data(), 3, 3);
  for (const double s : {0.0, 1.0, 10.0, 300.0}) {
    const Eigen::MatrixXd sI = s * Eigen::MatrixXd::Identity(n, n);
    const Eigen::MatrixXd H = C * (sI - A).lu().solve(Eigen::MatrixXd(B)) + D;
    const double diagonal = 0.02 * (s * s + 60 * s + 1000) / (s * s + 10.3 * s + 100);
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) EXPECT_NEAR(H(i, j), i == j ? diagonal : 0.1, 1e-13);
    }
  }
  EXPECT_EQ(hand.axes.at(0).velocity_m_s, 0.1);
}

TEST(Examples, CouplingIsReadFromItsFileAndRigidBehindIt) {
  const Compiled compiled = example("coupling.yaml");
  const build::ProgramSpec& spec = compiled.program->spec();
  EXPECT_EQ(spec.coupling.at(0).coordinates.size(), 3U);
  EXPECT_EQ(spec.encounters.at(0).surface.compliance, control::kRigidCompliance);
  EXPECT_LT(spec.coupling[0].stiffness(0, 0) * 0.001 / 2 + spec.coupling[0].damping(0, 0),
            compiled.assumed[0].min_damping[0]);
}

/// A device on USB is said to need no more latency than it has, and no less than its times add up to.
TEST(Examples, DevicesOnUsbHaveTheLatencyThatTheirTimesAddUpTo) {
  for (const char* name :
       {"falcon.yaml", "wooden_haptics.yaml", "teensy_rawhid.yaml", "openffboard_wheel.yaml"}) {
    const Compiled compiled = example(name);
    ASSERT_TRUE(compiled.usb.at(0)) << name;
    const usb::DeviceOptions& device = *compiled.usb[0];
    EXPECT_NEAR(compiled.assumed[0].latency_s,
                device.worst_sample_age_s + device.send_s + device.drive_delay_s + 50e-6, 1e-12)
        << name;
    EXPECT_FALSE(compiled.simulated[0].axes.empty()) << name << ": nothing to emulate";
  }
}

/// Its public driver: cos(A) (Lb sin(B) + Lc cos(B + C)), Ln + Lb cos(B) - Lc sin(B + C), C against body B.
TEST(Examples, WoodenHapticsIsTheChainOfItsPublicDriver) {
  const Compiled wood = example("wooden_haptics.yaml");
  const control::Serial& chain = wood.program->plan().serials[0];
  const double A = 0.2, B = -0.3, C = 0.4;
  const std::array<double, 3> q{A, B, C};
  control::LinkagePose pose;
  ASSERT_TRUE(control::pose_of(chain, q.data(), pose));
  const double radius = 0.205 * std::sin(B) + 0.245 * std::cos(B + C);
  EXPECT_NEAR(pose.tip[0], std::cos(A) * radius, 1e-9);
  EXPECT_NEAR(pose.tip[1], std::sin(A) * radius, 1e-9);
  EXPECT_NEAR(pose.tip[2], 0.080 + 0.205 * std::cos(B) - 0.245 * std::sin(B + C), 1e-9);
}

TEST(Examples, MeshIsTouchedWithABall) {
  const Compiled compiled = example("mesh.yaml");
  const build::ProgramSpec& spec = compiled.program->spec();
  EXPECT_EQ(spec.contacts.at(0).radius, 0.005);
  EXPECT_EQ(spec.meshes.at(0)->triangles.size(), 1280U);
  EXPECT_TRUE(spec.meshes[0]->repairs.empty()) << spec.meshes[0]->repairs[0];
}

TEST(Examples, MovingLidKeepsAProofAwayAndDoesNotAskForOne) {
  const Compiled lid = example("moving.yaml");
  EXPECT_EQ(lid.document.config.stability.require, Require::none);
  ASSERT_EQ(lid.assumed[0].active.size(), 1U);
  EXPECT_EQ(lid.assumed[0].active[0].object, "box 'lid'");
}

}  // namespace
}  // namespace hapticd::config::test
