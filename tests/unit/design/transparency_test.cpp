#include "control/design/synthesis/transparency.h"

#include <gtest/gtest.h>

#include <cmath>

#include "control/design/check/exact.h"
#include "control/design/check/spring_damper.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

class PublishedCoupling : public testing::TestWithParam<const char*> {
 protected:
  const nlohmann::json reference = paper1_reference();
  const nlohmann::json figures = reference.at("gamma").at(GetParam());
  const Matrix K = matrix_of(reference.at("couplings").at(GetParam()).at("K"));
  const Matrix B = matrix_of(reference.at("couplings").at(GetParam()).at("B"));
  const System scene = paper1_scene();
  const System coupling = check::spring_damper(K, B, kPeriod);
  const synthesis::Weights weights{synthesis::low_pass(125, kPeriod, 3),
                                   check::constant(identity(3))};
};

TEST_P(PublishedCoupling, LoopShapingNormIsTheReferences) {
  const check::Norm norm = synthesis::loop_shaping_norm(scene, coupling, weights);
  const double expected = figures.at("loop_shaping_norm");
  EXPECT_NEAR(norm.lower / expected, 1, 1e-6);
  EXPECT_NEAR(norm.upper / expected, 1, 1e-6);
  EXPECT_NEAR(norm.angle / kPeriod, figures.at("peak_omega").get<double>(), 0.01);
}

TEST_P(PublishedCoupling, ClosedLoopNormsAreTheReferences) {
  EXPECT_NEAR(synthesis::closed_loop_norm(scene, coupling, weights).upper /
                  figures.at("transparency23_weighted").get<double>(),
              1, 1e-4);
  EXPECT_NEAR(synthesis::closed_loop_norm(scene, coupling, synthesis::unweighted(3)).upper /
                  figures.at("transparency23_unweighted").get<double>(),
              1, 1e-4);
}

TEST_P(PublishedCoupling, ExactMarginIsTheReferences) {
  EXPECT_NEAR(
      check::exact_margin(check::feedback(scene, coupling), kDamping * identity(3), 0, kPeriod),
      figures.at("sampled_data_passivity_margin").get<double>(), 1e-6);
}

TEST_P(PublishedCoupling, UsesTheShareOfTheDampingThatTheReferenceSays) {
  EXPECT_NEAR(check::damping_share(K, B, kDamping * identity(3), kPeriod) * kDamping,
              figures.at("lmax_KT2_plus_B").get<double>(), 1e-7);
}

TEST_P(PublishedCoupling, OutputLevelOfTheSweepIsTheReferences) {
  const Matrix kappa = 0.5 * kPeriod / kDamping * identity(3);
  const System transformed = check::inverse(check::sum(coupling, check::constant(-kappa)));
  EXPECT_NEAR(check::positive_real_margin(transformed, Matrix::Zero(3, 3), kPeriod) /
                  figures.at("DeltaV_isotropic_freqgrid").get<double>(),
              1, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Paper, PublishedCoupling, testing::Values("eq26", "eq27", "eq28"));

TEST(HInfinity, OfAOneStateSystemIsItsValueAtRest) {
  const System g{Matrix::Constant(1, 1, 0.9), identity(1), identity(1), Matrix::Zero(1, 1)};
  EXPECT_NEAR(check::h_infinity(g).lower, 10, 1e-9);
  EXPECT_NEAR(check::h_infinity(g).upper, 10, 1e-5);
}

TEST(HInfinity, FindsAPeakOfAnyWidth) {
  for (const double distance : {1e-2, 1e-5, 1e-8}) {
    // Two poles (1 - d) exp(+- i a): with C = (1, 0), |G| near a is 1/(2 d sin a) to first order.
    const double a = 1.234, r = 1 - distance;
    Matrix A(2, 2);
    A << 2 * r * std::cos(a), -r * r, 1, 0;
    const System g{A, Matrix::Identity(2, 1), Matrix::Identity(1, 2), Matrix::Zero(1, 1)};
    const check::Norm norm = check::h_infinity(g);
    EXPECT_NEAR(norm.upper * 2 * distance * std::sin(a), 1, 2 * distance + 1e-6);
    EXPECT_NEAR(norm.angle, a, 2 * distance);
  }
}

TEST(HInfinity, OfAnUnstableSystemIsInfinite) {
  const System g{Matrix::Constant(1, 1, 1.1), identity(1), identity(1), Matrix::Zero(1, 1)};
  EXPECT_TRUE(std::isinf(check::h_infinity(g).upper));
  EXPECT_EQ(check::h_infinity(check::constant(3 * identity(2))).upper, 3);
  System odd = g;
  odd.A(0, 0) = std::nan("");
  EXPECT_TRUE(std::isnan(check::h_infinity(odd).upper));
}

}  // namespace
}  // namespace hapticd::test
