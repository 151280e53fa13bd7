// The damper of the paper's wall by the exact loop, against figures computed elsewhere, and against the
// paper's own.
#include "control/design/synthesis/robust_wall.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/paper2_loop.h"

namespace hapticd::test {
namespace {

using synthesis::RobustWallDesign;
using synthesis::RobustWallGoal;

RobustWallGoal paper2_goal(bool ideal = false, bool step = false, double latency_s = 0) {
  RobustWallGoal goal;
  goal.wall = ideal ? paper2_wall(std::nullopt) : paper2_wall();
  goal.meant = {.stiffness_N_m = 1000, .damping_Ns_m = 1};
  if (step) goal.meant.weight = {Vector::Ones(1), Eigen::Vector2d(0, 1)};
  goal.box = {.mass_kg = {0.005, 0.015},
              .damping_Ns_m = {0.011, 0.033},
              .latency_s = {latency_s, latency_s}};
  goal.cases = paper2_box(latency_s);
  return goal;
}

TEST(RobustWall, DamperOfLeastLargestIndexIsTheReferences) {
  for (const bool step : {false, true}) {
    const auto& expected =
        paper2_design().at("exact_misc").at(step ? "minmaxJ_step_bd" : "minmaxJ_w1_100_bd");
    const RobustWallDesign design = synthesis::design_wall(paper2_goal(false, step));
    EXPECT_EQ(design.why, "");
    EXPECT_NEAR(design.damper_Ns_m, expected[0].get<double>(), 1e-4);
    EXPECT_NEAR(design.index / expected[1].get<double>(), 1, 1e-6);
    EXPECT_EQ(design.robust.kind, check::Robust::proved_constant) << design.robust.why;
    EXPECT_EQ(design.damper_Ns_m == 0, design.P.empty());
  }
}

TEST(RobustWall, LargestIndexWithTheTrueVelocityIsTheReferences) {
  // The reference looked up to 9.8 only, where the index still falls.
  for (const bool step : {false, true}) {
    const auto& expected =
        paper2_design().at("exact_misc").at(step ? "minmaxJ_step_ideal" : "minmaxJ_w1_100_ideal");
    const RobustWallGoal goal = paper2_goal(true, step);
    const double there =
        synthesis::largest_index(loop_of(goal.wall, expected[0]), goal.cases, goal.meant).value;
    EXPECT_NEAR(there / expected[1].get<double>(), 1, 1e-6);
    const RobustWallDesign design = synthesis::design_wall(goal);
    EXPECT_LE(design.index, there);
    EXPECT_LT(design.damper_Ns_m, 9.9998);
  }
}

TEST(RobustWall, ThePapersDamperStandsBesideAndIsNotRobust) {
  const RobustWallDesign design = synthesis::design_wall(paper2_goal());
  EXPECT_NEAR(design.paper.damper_Ns_m, 15.1744412, 1e-5);
  EXPECT_TRUE(design.paper.answer.robust);
  const check::RobustAnswer there =
      check::robust(loop_of(paper2_wall(), design.paper.damper_Ns_m), paper2_goal().box);
  EXPECT_EQ(there.kind, check::Robust::no) << there.why;
}

TEST(RobustWall, FailsWhereTheSampledLoopDoesThoughThePaperPasses) {
  const RobustWallDesign design = synthesis::design_wall(paper2_goal(false, false, kPeriod_s));
  EXPECT_EQ(design.damper_Ns_m, 0);
  EXPECT_TRUE(design.paper.answer.robust);
  EXPECT_NE(design.why.find("mass 0.005 kg"), std::string::npos) << design.why;
  EXPECT_NE(design.why.find("9 cases"), std::string::npos) << design.why;
}

TEST(RobustWall, HandsThatHoldOnAreJudgedByWhatTheyWouldFeelAtTheWall) {
  RobustWallGoal goal = paper2_goal();
  goal.cases.clear();
  goal.box.damping_Ns_m = {0.022, 0.022};
  goal.box.hand_kg = {0, 0.03};
  goal.box.hand_Ns_m = {2, 3};
  goal.box.hand_N_m = {100, 100};
  goal.per_side = 2;
  const RobustWallDesign design = synthesis::design_wall(goal);
  EXPECT_EQ(design.why, "");
  EXPECT_EQ(design.robust.kind, check::Robust::proved_constant) << design.robust.why;
  const auto cases = check::cases_of(goal.box, 2);
  EXPECT_EQ(cases.size(), 8u);
  for (const double factor : {0.9, 0.97, 1.03, 1.1})
    EXPECT_GT(
        synthesis::largest_index(loop_of(goal.wall, factor * design.damper_Ns_m), cases, goal.meant)
            .value,
        design.index);
}

TEST(RobustWall, SaysWhatItCannotRead) {
  RobustWallGoal goal = paper2_goal();
  goal.box.mass_kg.low = 0;
  EXPECT_FALSE(synthesis::design_wall(goal).why.empty());
  goal = paper2_goal();
  goal.meant.weight.den = Vector::Zero(1);
  EXPECT_FALSE(synthesis::design_wall(goal).why.empty());
}

}  // namespace
}  // namespace hapticd::test
