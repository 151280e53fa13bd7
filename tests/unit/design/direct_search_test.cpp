#include "control/design/synthesis/direct_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/design/check/spring_damper.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

/// Example 2: weight 1/(1 + s/125) on the scene's side.
synthesis::DirectGoal example2() {
  return {.scene = paper1_scene(),
          .damping = Vector::Constant(3, kDamping),
          .latency_s = 0,
          .period_s = kPeriod,
          .weights = {synthesis::low_pass(125, kPeriod, 3), check::constant(identity(3))}};
}

TEST(DirectSearch, ReachesTheInfimumOfThePapersClass) {
  const synthesis::DirectDesign design =
      synthesis::most_transparent_for_any_scene(example2(), 0.9998);
  ASSERT_EQ(design.stiffness.size(), 3) << design.why;
  const double infimum = paper1_reference().at("optimum").at("gamma_infimum");
  EXPECT_LE(design.gamma, 12.62);
  EXPECT_GT(design.gamma, infimum);
  EXPECT_LT(check::damping_share(design.stiffness.asDiagonal(), design.damper.asDiagonal(),
                                 kDamping * identity(3), kPeriod),
            1);
}

TEST(DirectSearch, TheExactTestAllowsThreeTimesTheTransparency) {
  const synthesis::DirectGoal goal = example2();
  const synthesis::DirectDesign design = synthesis::most_transparent_exact(goal, 1e-3);
  ASSERT_TRUE(design.certificate.P) << design.why;
  EXPECT_LE(design.gamma, 3.85);
  EXPECT_GT(design.gamma, 3.84);
  EXPECT_GE(design.margin, 1e-3);
  EXPECT_GE(design.damper.minCoeff(), 0);
  RecordProperty("gamma", std::to_string(design.gamma));
}

TEST(DirectSearch, StiffestEqualSpringsAreAtTheReferenceLimit) {
  const synthesis::DirectDesign design =
      synthesis::stiffest_exact(example2(), Vector::Ones(3), 1e-6);
  ASSERT_TRUE(design.certificate.P) << design.why;
  EXPECT_NEAR(design.stiffness(0), 8704.56, 0.2);
  EXPECT_EQ(design.stiffness(0), design.stiffness(2));
}

TEST(DirectSearch, WithLatencyTheCouplingKeepsTheSharperInequality) {
  synthesis::DirectGoal goal = example2();
  goal.latency_s = 0.5e-3;
  const synthesis::DirectDesign design = synthesis::most_transparent_for_any_scene(goal, 0.999);
  ASSERT_EQ(design.stiffness.size(), 3) << design.why;
  EXPECT_GT(design.margin, 0);
  // Springs alone could be K (T + 3 tau)/2 < Delta: 1096 N/m.
  EXPECT_GT(design.stiffness.minCoeff(), 1090);
}

TEST(DirectSearch, RefusesWhatItCannotRead) {
  synthesis::DirectGoal goal = example2();
  goal.damping(1) = -1;
  EXPECT_FALSE(synthesis::most_transparent_exact(goal, 1e-3).why.empty());
  EXPECT_EQ(synthesis::most_transparent_exact(goal, 1e-3).stiffness.size(), 0);
  goal = example2();
  goal.scene.A(0, 0) = std::nan("");
  EXPECT_EQ(synthesis::most_transparent_for_any_scene(goal, 0.9).stiffness.size(), 0);
  EXPECT_EQ(synthesis::most_transparent_for_any_scene(example2(), 1.0).stiffness.size(), 0);
  // More than the device has can never be left over.
  EXPECT_EQ(synthesis::stiffest_exact(example2(), Vector::Ones(3), 2).stiffness.size(), 0);
}

}  // namespace
}  // namespace hapticd::test
