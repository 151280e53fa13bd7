// What hapticctl check says of a config, for people and for machines.
#include "config/print.h"

#include <nlohmann/json.hpp>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

TEST(Print, CouplingAndObjectsAreNamedWithTheirFigures) {
  const std::string coupling = describe_plan(example("coupling.yaml"));
  for (const char* part : {"coupling: contacts [stylus], stiffness 800 N/m, damping 0.1 N s/m",
                           "box block: ", "rigid, ", "size [0.12, 0.12, 0.04] m", "felt by stylus",
                           "solver: max_sweeps 50"}) {
    EXPECT_NE(coupling.find(part), std::string::npos) << part << "\n" << coupling;
  }
  const std::string friction = describe_plan(example("friction.yaml"));
  EXPECT_NE(friction.find("friction (static 0.6, dynamic 0.4)"), std::string::npos) << friction;
  const std::string paper = describe_plan(example("paper1_example1.yaml"));
  EXPECT_NE(paper.find("network star: nodes [(name mass, mass 3 kg"), std::string::npos) << paper;
}

TEST(Print, JsonHasTheKeysOfTheScene) {
  const auto json = nlohmann::json::parse(plan_json(example("coupling.yaml")));
  EXPECT_EQ(json["coupling"]["blocks"][0]["stiffness_N_m"], 800);
  EXPECT_EQ(json["scene"][0]["kind"], "box");
  EXPECT_EQ(json["scene"][0]["rigid"], true);
  EXPECT_TRUE(json["scene"][0]["friction"].is_null());
  EXPECT_EQ(json["scene"][0]["devices"], nlohmann::json::array({"stylus"}));
  EXPECT_TRUE(nlohmann::json::parse(plan_json(example("wall.yaml")))["coupling"].is_null());
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
  EXPECT_TRUE(json["devices"][0]["assumed"]["obstacles"].empty());
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
