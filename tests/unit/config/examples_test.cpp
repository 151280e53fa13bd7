// The shipped examples are sound, and say what they claim.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "config/print.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

Compiled example(const std::string& name) {
  auto compiled = load(source_path("config/examples/" + name));
  EXPECT_TRUE(compiled) << listed(compiled ? std::vector<ConfigError>{} : compiled.error());
  return compiled ? std::move(*compiled) : Compiled{};
}

TEST(Examples, EveryOneCompiles) {
  int count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(source_path("config/examples"))) {
    if (entry.path().extension() != ".yaml") continue;
    ++count;
    EXPECT_TRUE(load(entry.path().string())) << entry.path();
  }
  EXPECT_GE(count, 7);
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

TEST(Print, LinkagesAndCompensationAreNamed) {
  const std::string arm = describe_plan(example("five_bar.yaml"));
  for (const char* part : {"contact five_bar", "axis left: 32768 counts/revolution", "0.4 N m",
                           "20 rad/s", "no model"}) {
    EXPECT_NE(arm.find(part), std::string::npos) << part << "\n" << arm;
  }
  const std::string slide = describe_plan(example("observer.yaml"));
  for (const char* part : {"observer: model, order 2, 10 Hz", "friction compensated: 0.99 N s/m",
                           "dry friction 0.4 N"}) {
    EXPECT_NE(slide.find(part), std::string::npos) << part << "\n" << slide;
  }
  const std::string homing = describe_plan(example("homing.yaml"));
  for (const char* part : {"homed by hard_stop at -0.05 m, search with -1 N",
                           "travel: -0.045 to 0.045 m", "input 0 is dead_man: forces while 1"}) {
    EXPECT_NE(homing.find(part), std::string::npos) << part << "\n" << homing;
  }
  const std::string falcon = describe_plan(example("falcon_sim.yaml"));
  for (const char* part :
       {"stands at [-0.12, 0, 0] m", "continuous: 0.2 N m", "workspace: [-0.05"}) {
    EXPECT_NE(falcon.find(part), std::string::npos) << part << "\n" << falcon;
  }
}

TEST(Print, JsonOfARotaryAxisHasItsUnits) {
  const auto json = nlohmann::json::parse(plan_json(example("falcon_sim.yaml")));
  const auto& axis = json["devices"][0]["axes"][0];
  EXPECT_EQ(json["devices"][0]["kinematics"], "delta");
  EXPECT_EQ(axis["kind"], "rotary");
  EXPECT_EQ(axis["max_torque_Nm"], 0.4);
  EXPECT_EQ(axis["offset_rad"], 0.6109);
  EXPECT_EQ(axis["homing"], "device");
  EXPECT_TRUE(axis["direction"].is_null());
  EXPECT_FALSE(json["devices"][0]["assumed"]["obstacles"].empty());
}

TEST(Print, TextForPeopleNamesEverything) {
  const std::string text = describe_plan(example("two_devices.yaml"));
  for (const char* part :
       {"1000 Hz", "device stylus (sim)", "axis b along y", "reversed", "device lever",
        "guard: 2 N, 0.8 m/s, 200 N/s", "damping at least 0.81 N s/m", "plane floor",
        "felt by stylus", "/run/hapticd/hapticd.sock", "/var/lib/hapticd", "recording: none",
        "demanded: passive"}) {
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  }
}

TEST(Print, JsonSaysTheSameForMachines) {
  const Compiled two = example("two_devices.yaml");
  const auto json = nlohmann::json::parse(plan_json(two));
  EXPECT_EQ(json["digest"], two.document.digest);
  EXPECT_EQ(json["devices"][1]["guard"]["max_slew_N_s"], 200);
  EXPECT_EQ(json["devices"][0]["axes"][1]["m_per_count"], -1e-6);
  EXPECT_EQ(json["devices"][1]["axes"][0]["stuck_s"], 2);
  EXPECT_EQ(json["devices"][1]["assumed"]["min_damping_Ns_m"][0], 0.9 * (1 - 0.1));
  EXPECT_EQ(json["scene"][0]["devices"], nlohmann::json::array({"stylus"}));
  EXPECT_TRUE(json["record"].is_null());
}

}  // namespace
}  // namespace hapticd::config::test
