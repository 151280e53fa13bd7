#include "sim/script.h"

#include <gtest/gtest.h>

namespace hapticd::sim {
namespace {

constexpr double kSubstep_s = 1e-4;

TEST(Script, EmptyIsAHandAtRestWhereTheDeviceStarts) {
  Script script({}, 0.3, kSubstep_s);
  for (const std::int64_t substep : {-5, 0, 100'000}) {
    EXPECT_EQ(script.at(substep).force_N, 0);
    EXPECT_EQ(script.at(substep).rest_m, 0.3);
    EXPECT_EQ(script.at(substep).rest_rate_m_s, 0);
  }
}

TEST(Script, ForceIsHeldFromStepToStep) {
  Script script({{.at_s = 0, .force_N = 5}, {.at_s = 0.1, .force_N = -2}}, 0, kSubstep_s);
  EXPECT_EQ(script.at(-1).force_N, 0);
  EXPECT_EQ(script.at(0).force_N, 5);
  EXPECT_EQ(script.at(999).force_N, 5);
  EXPECT_EQ(script.at(1000).force_N, -2);
  EXPECT_EQ(script.at(1'000'000).force_N, -2);
}

TEST(Script, RestMovesLinearlyFromTheStartAndBetweenSteps) {
  Script script({{.at_s = 0.1, .position_m = 0.02}, {.at_s = 0.2, .position_m = 0.01}}, 0.01,
                kSubstep_s);
  EXPECT_DOUBLE_EQ(script.at(0).rest_m, 0.01);
  EXPECT_DOUBLE_EQ(script.at(500).rest_m, 0.015);
  EXPECT_DOUBLE_EQ(script.at(500).rest_rate_m_s, 0.1);
  EXPECT_DOUBLE_EQ(script.at(1000).rest_m, 0.02);
  EXPECT_DOUBLE_EQ(script.at(1500).rest_m, 0.015);
  EXPECT_DOUBLE_EQ(script.at(1500).rest_rate_m_s, -0.1);
  EXPECT_DOUBLE_EQ(script.at(2000).rest_m, 0.01);
  EXPECT_EQ(script.at(9000).rest_rate_m_s, 0);
}

TEST(Script, StepAtZeroMovesTheRestAtOnce) {
  Script script({{.at_s = 0, .position_m = 0.05}}, 0, kSubstep_s);
  EXPECT_EQ(script.at(-1).rest_m, 0);
  EXPECT_EQ(script.at(0).rest_m, 0.05);
}

TEST(Script, RunsAgainAfterARestart) {
  Script script({{.at_s = 0, .force_N = 1}, {.at_s = 0.1, .force_N = 2}}, 0, kSubstep_s);
  EXPECT_EQ(script.at(5000).force_N, 2);
  script.restart();
  EXPECT_EQ(script.at(0).force_N, 1);
}

}  // namespace
}  // namespace hapticd::sim
