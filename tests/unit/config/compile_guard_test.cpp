// Limits that only some devices name.
#include <cmath>

#include "tests/unit/config/five_bar_text.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

std::string with_guard(const std::string& keys) {
  return replaced(kSmall, "guard: {max_force_N: 6", "guard: {max_force_N: 6, " + keys);
}
std::string with_device(const std::string& keys) {
  return replaced(kSmall, "    latency_s: 0\n", "    latency_s: 0\n    " + keys + "\n");
}

TEST(CompileGuard, WhatIsNotNamedIsNotThere) {
  const Compiled compiled = compiled_of(kSmall);
  const control::Plan& plan = compiled.program->plan();
  EXPECT_TRUE(plan.power_limits.empty());
  EXPECT_TRUE(plan.workspaces.empty());
  EXPECT_TRUE(plan.enable_inputs.empty());
  EXPECT_TRUE(plan.passivity_controllers.empty());
}

TEST(CompileGuard, RotaryAxesHaveTheirOwnSpeedLimit) {
  const Compiled compiled =
      compiled_of(replaced(kFiveBar, "max_force_N: 1.5",
                           "max_force_N: 1.5, max_velocity_m_s: 3, max_velocity_rad_s: 7"));
  EXPECT_EQ(compiled.program->plan().axes[0].max_velocity, 7);
  expect_error(replaced(kFiveBar, "bits: 24", "bits: 5"), "10:48",
               "devices[0].axes[0].encoder.bits", {"max_velocity_rad_s 10", "at least 11 bits"});
}

TEST(CompileGuard, PowerIsLimitedPerDevice) {
  const Compiled compiled = compiled_of(with_guard("max_power_W: 20"));
  ASSERT_EQ(compiled.program->plan().power_limits.size(), 1U);
  EXPECT_EQ(compiled.program->plan().power_limits[0].max_W, 20);
}

TEST(CompileGuard, WorkspaceIsThatOfTheContactsCoordinates) {
  const std::string text = with_guard("workspace: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}");
  const Compiled compiled =
      compiled_of(replaced(replaced(text, "[x]", "[z]"), "[1, 0, 0]", "[0, 0, 1]"));
  const auto workspaces = compiled.program->plan().workspaces;
  ASSERT_EQ(workspaces.size(), 1U);
  EXPECT_EQ(workspaces[0].min[0], -3) << "the only coordinate is z";
  EXPECT_EQ(workspaces[0].max[0], 3);
  expect_error(replaced(text, "[1, 2, 3]", "[1, -2, 3]"), "15:69", "guard.workspace.max_m[1]",
               {"more than min_m", "-2 m"});
}

TEST(CompileGuard, DevicesWorkspaceReplacesTheGlobalOne) {
  const std::string text =
      replaced(with_guard("workspace: {min_m: [-1, -2, -3], max_m: [1, 2, 3]}"), "    axes:",
               "    guard: {workspace: {min_m: [-7, -7, -7], max_m: [7, 7, "
               "7]}}\n    axes:");
  EXPECT_EQ(compiled_of(text).program->plan().workspaces[0].min[0], -7);
}

TEST(CompileGuard, EnableInputsAreBits) {
  const Compiled compiled =
      compiled_of(with_device("enable_inputs: [{bit: 3, role: estop}, {bit: 31, active: false}]"));
  const auto inputs = compiled.program->plan().enable_inputs;
  ASSERT_EQ(inputs.size(), 2U);
  EXPECT_EQ(inputs[0].mask, 8U);
  EXPECT_EQ(inputs[0].active, 8U);
  EXPECT_TRUE(inputs[0].estop);
  EXPECT_EQ(inputs[1].mask, 0x80000000U);
  EXPECT_EQ(inputs[1].active, 0U);
  EXPECT_FALSE(inputs[1].estop);
  expect_error(with_device("enable_inputs: [{bit: 3}, {bit: 3, active: false}]"), "8:37",
               "devices[0].enable_inputs[1].bit", {"input 3", "one role"});
}

TEST(CompileGuard, PassivityControllerHasItsBudget) {
  const Compiled compiled =
      compiled_of(with_guard("ramp_s: 0.25, passivity_controller: {budget_J: 0.01, leak_s: 2}"));
  const auto controllers = compiled.program->plan().passivity_controllers;
  ASSERT_EQ(controllers.size(), 1U);
  EXPECT_EQ(controllers[0].budget, 0.01);
  EXPECT_EQ(controllers[0].credit, 0.5);
  EXPECT_NEAR(controllers[0].leak, 1 - std::exp(-0.0005), 1e-15);
  EXPECT_EQ(controllers[0].rise, 0.004);
  const Compiled plain = compiled_of(with_guard("passivity_controller: {}"));
  EXPECT_EQ(plain.program->plan().passivity_controllers[0].budget, 0.002);
  EXPECT_EQ(plain.program->plan().passivity_controllers[0].leak, 0);
}

}  // namespace
}  // namespace hapticd::config::test
