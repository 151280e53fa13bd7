// The shipped examples are sound, and say what they claim.
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
  EXPECT_GE(count, 3);
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
