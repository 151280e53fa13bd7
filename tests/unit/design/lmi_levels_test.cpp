#include "control/design/synthesis/lmi_levels.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "control/design/synthesis/balance.h"
#include "tests/support/paper_loop.h"

namespace hapticd::synthesis {
namespace {

using check::Vector;
using test::eye;

/// One pole at `a`, feed-through `d`: d + c / (z - a).
System first_order(double a, double c, double d) {
  return {eye(1, a), eye(1), eye(1, c), eye(1, d)};
}

TEST(PaperScene, IsTheReferences) {
  const System scene = test::paper_scene(3);
  for (const auto& at : test::paper1_reference()["E_frequency_response"]) {
    const check::Complex z = std::polar(1.0, test::kPaperPeriod_s * at["omega"].get<double>());
    const check::ComplexMatrix e = check::at(scene, z);
    EXPECT_LT((e.real() - test::matrix_of(at["re"])).norm(), 1e-8 * e.norm());
    EXPECT_LT((e.imag() - test::matrix_of(at["im"])).norm(), 1e-8 * e.norm());
  }
}

// Re (d + c / (z - a)) for 0 < a < 1, c > 0 is least at z = -1: d - c / (1 + a).
TEST(InputLevel, IsTheLeastRealPart) {
  const Level level = lmi_input_level(first_order(0.5, 0.3, 1));
  ASSERT_TRUE(level.found) << level.why;
  EXPECT_NEAR(level.level(0, 0), 1 - 0.3 / 1.5, 1e-7);
}

TEST(InputLevel, MayBeNegative) {
  const Level level = lmi_input_level(first_order(0.5, 3, 1));
  ASSERT_TRUE(level.found) << level.why;
  EXPECT_NEAR(level.level(0, 0), 1 - 3 / 1.5, 1e-7);
}

// 1 / (d + c / (z - a)): the least real part of the inverse is at z = 1.
TEST(OutputLevel, IsTheInputLevelOfTheInverse) {
  const Level level = lmi_output_level(first_order(0.5, 0.3, 1));
  ASSERT_TRUE(level.found) << level.why;
  EXPECT_NEAR(level.level(0, 0), 1 / (1 + 0.3 / 0.5), 1e-7);
}

TEST(InputLevel, OfAnIntegratorIsHalfItsResidueLess) {
  // T z/(z-1) has real part T/2 all around the circle.
  const System integrator{eye(1), eye(1), eye(1, test::kPaperPeriod_s),
                          eye(1, test::kPaperPeriod_s)};
  const Level level = lmi_input_level(integrator);
  ASSERT_TRUE(level.found) << level.why;
  EXPECT_NEAR(level.level(0, 0), test::kPaperPeriod_s / 2, 1e-9 * test::kPaperPeriod_s);
}

TEST(InputLevel, RefusesADoubleIntegratorAndAnUnstablePole) {
  System twice = first_order(1, 1, 1);
  twice = check::series(twice, twice);
  EXPECT_FALSE(lmi_input_level(twice).found);
  EXPECT_FALSE(lmi_input_level(first_order(1.01, 1, 1)).found);
  EXPECT_FALSE(lmi_input_level(first_order(1, -1, 1)).found);  // residue < 0
  EXPECT_FALSE(lmi_output_level(first_order(0.5, 1, 0)).found);
}

TEST(InputLevel, OfThePapersSceneIsTheReferences) {
  const System scene = transformed_scene(test::paper_scene(3), test::kPaperPeriod_s);
  const Level level = lmi_input_level(scene, LevelShape::isotropic);
  ASSERT_TRUE(level.found) << level.why;
  EXPECT_NEAR(level.level(0, 0),
              -test::paper1_reference()["ISP_index"]["Phi_star_isotropic"].get<double>(), 1e-6);
}

TEST(InputLevel, OfALateSceneIsTheReferences) {
  for (const auto& [name, scale] :
       {std::pair{"scale1", 1.0}, {"scale0.5", 0.5}, {"scale0.25", 0.25}}) {
    const System scene = transformed_scene(test::late_loop(scale).scene, test::kPaperPeriod_s);
    const Level level = lmi_input_level(scene, LevelShape::isotropic);
    ASSERT_TRUE(level.found) << level.why;
    EXPECT_NEAR(level.level(0, 0),
                -test::paper1_reference()["ISP_index"]["delay1"][name].get<double>(), 1e-6);
  }
}

TEST(OutputLevel, OfThePapersCouplingsIsTheReferences) {
  for (const char* name : {"eq26", "eq27", "eq28"}) {
    const auto& k = test::paper1_reference()["couplings"][name];
    const System v = transformed_coupling(
        spring_damper(test::matrix_of(k["K"]), test::matrix_of(k["B"]), test::kPaperPeriod_s),
        test::paper_loop());
    const Level level = lmi_output_level(v, LevelShape::isotropic);
    ASSERT_TRUE(level.found) << level.why;
    const double expected = test::paper1_reference()["gamma"][name]["DeltaV_isotropic_freqgrid"];
    EXPECT_NEAR(level.level(0, 0), expected, 1e-6 * expected) << name;
  }
}

// One axis: K T / (2 p) + B / p^2, p = 1 - K T / (2 Delta).
TEST(OutputLevel, OfASpringAndDamperIsTheClosedForm) {
  const HapticLoop loop{check::constant(eye(1)), eye(1, 1.37), test::kPaperPeriod_s};
  for (const double k : {10.0, 700.0, 2600.0}) {
    for (const double b : {0.0, 0.03, -0.002}) {
      if (b < 0 && k < 100) continue;
      const double p = 1 - k * test::kPaperPeriod_s / (2 * 1.37);
      const Level level = lmi_output_level(
          transformed_coupling(spring_damper(eye(1, k), eye(1, b), test::kPaperPeriod_s), loop));
      ASSERT_TRUE(level.found) << level.why;
      const double expected = k * test::kPaperPeriod_s / (2 * p) + b / (p * p);
      EXPECT_NEAR(level.level(0, 0), expected, 2e-6 * expected) << k << " " << b;
    }
  }
}

// Matrix levels of springs alone: (T/2) (K^-1 - (T/2) Delta^-1)^-1.
TEST(OutputLevel, OfCoupledSpringsIsTheClosedFormMatrix) {
  Matrix k(2, 2);
  k << 900, 300, 300, 500;
  HapticLoop loop{check::constant(eye(2)), Matrix(Eigen::Vector2d(1.4, 0.9).asDiagonal()),
                  test::kPaperPeriod_s};
  const Level level = lmi_output_level(
      transformed_coupling(spring_damper(k, Matrix::Zero(2, 2), test::kPaperPeriod_s), loop),
      LevelShape::full);
  ASSERT_TRUE(level.found) << level.why;
  const Matrix expected =
      0.5 * test::kPaperPeriod_s *
      (k.inverse() - 0.5 * test::kPaperPeriod_s * loop.device_level.inverse()).inverse();
  EXPECT_LT((level.level - expected).norm(), 1e-5 * expected.norm());
}

// Lemmas 1 and 2 are one statement: both matrices are > 0, or none.
TEST(Lemmas, OneAndTwoAgree) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto any = [&](Eigen::Index rows, Eigen::Index columns) {
    return Matrix(Matrix::NullaryExpr(rows, columns, [&] { return unit(random); }));
  };
  int yes = 0, no = 0;
  for (int i = 0; i < 400; ++i) {
    System g{0.4 * any(2, 2), 0.5 * any(2, 2), 0.5 * any(2, 2), 0.5 * any(2, 2) + eye(2)};
    const Matrix root = any(2, 2), p = root * root.transpose() + 0.1 * eye(2);
    const Matrix delta = eye(2, 0.05), phi = eye(2, 0.2 * unit(random));
    const double one = check::smallest_eigenvalue(lemma1(g, p, delta, phi));
    const double two = check::smallest_eigenvalue(lemma2(g, p.inverse(), delta, phi));
    if (std::abs(one) < 1e-6) continue;
    EXPECT_EQ(one > 0, two > 0);
    ++(one > 0 ? yes : no);
  }
  EXPECT_GT(yes, 20);
  EXPECT_GT(no, 20);
}

TEST(Balanced, KeepsTheResponseAndDropsWhatIsNotSeen) {
  const System scene = without_integrator(test::paper_scene(3), test::kPaperPeriod_s);
  const auto small = balanced(scene);
  ASSERT_TRUE(small);
  EXPECT_EQ(small->states(), 2);  // one mass
  for (const double angle : {0.0, 0.0663, 0.5, 3.0}) {
    const check::Complex z = std::polar(1.0, angle);
    EXPECT_LT((check::at(scene, z) - check::at(*small, z)).norm(),
              1e-8 * check::at(scene, z).norm());
  }
  EXPECT_FALSE(balanced(first_order(1.0, 1, 1)));
}

}  // namespace
}  // namespace hapticd::synthesis
