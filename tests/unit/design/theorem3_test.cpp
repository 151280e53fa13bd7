#include "control/design/synthesis/theorem3.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <numeric>

#include "control/design/check/positive_real.h"
#include "tests/support/paper_loop.h"

namespace hapticd::synthesis {
namespace {

using test::eye;

Theorem3 springs(const HapticLoop& loop, double stiffness) {
  return theorem3(loop, spring_damper(eye(3, stiffness), eye(3, 0), test::kPaperPeriod_s));
}

TEST(DeviceLevel, IsBlockDiagonal) {
  Matrix two(2, 2);
  two << 3, 1, 1, 2;
  const Matrix all = device_level({eye(1, 5), two});
  Matrix expected(3, 3);
  expected << 5, 0, 0, 0, 3, 1, 0, 1, 2;
  EXPECT_EQ(all, expected);
}

TEST(Theorem3, MarginsOfThePapersCouplingsAreTheReferences) {
  const HapticLoop loop = test::paper_loop();
  for (const char* name : {"eq26", "eq27", "eq28"}) {
    const auto& k = test::paper1_reference()["couplings"][name];
    const Theorem3 answer = theorem3(
        loop,
        spring_damper(test::matrix_of(k["K"]), test::matrix_of(k["B"]), test::kPaperPeriod_s));
    EXPECT_TRUE(answer.stable) << name << ": " << answer.why;
    EXPECT_NEAR(answer.margin_Ns_m,
                test::paper1_reference()["theorem3_margin_t"][name].get<double>(), 1e-6)
        << name;
    EXPECT_TRUE(
        check::proves_positive_real(loop.scene, answer.Phi_E, answer.P_E, test::kPaperPeriod_s)
            .holds);
    EXPECT_GT(check::smallest_eigenvalue(
                  stability_matrix(loop.device_level, answer.Phi_E, answer.Delta_V)),
              0);
    EXPECT_NEAR(std::accumulate(answer.limits.begin(), answer.limits.end(), 0.0), 1, 1e-9);
  }
}

TEST(Theorem3, SpringsPassUpTo2740) {
  const HapticLoop loop = test::paper_loop();
  EXPECT_TRUE(springs(loop, 2735).stable);
  EXPECT_TRUE(springs(loop, 2739.9).stable);
  EXPECT_FALSE(springs(loop, 2740.1).stable);
  EXPECT_FALSE(springs(loop, 2745).stable);
  EXPECT_TRUE(springs(loop, 2745).decided);
}

// 2 Phi* / T < K < 2 Delta_D / T.
TEST(Theorem3, ALateSceneBoundsTheStiffnessOnBothSides) {
  for (const auto& [name, scale] : {std::pair{"scale0.5", 0.5}, {"scale0.25", 0.25}}) {
    const HapticLoop loop = test::late_loop(scale);
    const double least = 2 / test::kPaperPeriod_s *
                         test::paper1_reference()["ISP_index"]["delay1"][name].get<double>();
    EXPECT_FALSE(springs(loop, 0.9995 * least).stable) << scale;
    EXPECT_TRUE(springs(loop, 1.0005 * least).stable) << scale;
    EXPECT_TRUE(springs(loop, 2739).stable) << scale;
    EXPECT_FALSE(springs(loop, 2741).stable) << scale;
  }
}

TEST(Theorem3, ALateSceneAtFullScaleIsTooMuch) {
  for (const double stiffness : {500.0, 2000.0, 2700.0}) {
    EXPECT_FALSE(springs(test::late_loop(1), stiffness).stable);
  }
}

TEST(Theorem3, NamesTheContactThatLimits) {
  HapticLoop loop = test::paper_loop();
  loop.device_level(1, 1) = 0.5;
  const Theorem3 soft = springs(loop, 700);
  ASSERT_TRUE(soft.stable) << soft.why;
  EXPECT_GT(soft.limits[1], soft.limits[0] + soft.limits[2]);
  const Theorem3 stiff = springs(loop, 1200);  // 2 * 0.5 / T = 1000
  EXPECT_FALSE(stiff.stable);
  EXPECT_EQ(stiff.limits[1], 1);
}

TEST(Theorem3, RefusesUnstablePartsAndNoDamping) {
  HapticLoop loop = test::paper_loop();
  loop.scene.A(3, 3) = 1.5;
  EXPECT_FALSE(springs(loop, 700).stable);
  loop = test::paper_loop();
  loop.device_level(2, 2) = 0;
  EXPECT_FALSE(springs(loop, 700).stable);
  loop = test::paper_loop();
  loop.scene.C(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(springs(loop, 700).stable);
}

}  // namespace
}  // namespace hapticd::synthesis
