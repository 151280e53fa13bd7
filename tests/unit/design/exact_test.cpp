#include "control/design/check/exact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "control/design/synthesis/exact_certificate.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

const Matrix kDelta = kDamping * identity(3);

System equal_springs(double stiffness) {
  return sprung(paper1_scene(), stiffness * identity(3));
}

TEST(ExactPassivity, WithoutCouplingTheSceneLacksTheDampingThatTheReferenceSays) {
  const double expected = paper1_reference().at("no_coupling").at("sampled_data_passivity_margin");
  EXPECT_NEAR(check::exact_margin(paper1_scene(), kDelta, 0, kPeriod), expected, 1e-6);
}

TEST(ExactPassivity, EqualSpringsPassUpToTheReferenceLimit) {
  const double limit = paper1_reference().at("limits").at("sampled_data_passivity_K_max_B0_this_E");
  EXPECT_GT(check::exact_margin(equal_springs(limit - 0.02), kDelta, 0, kPeriod), 0);
  EXPECT_LT(check::exact_margin(equal_springs(limit + 0.02), kDelta, 0, kPeriod), 0);
}

struct Limit {
  double latency_s, passes, fails;
};

TEST(ExactCertificate, ExistsUpToTheLimitAndNotBeyond) {
  for (const auto& [latency, passes, fails] :
       {Limit{0, 8704, 8713}, Limit{0.2e-3, 3668, 3672}, Limit{0.5e-3, 2000, 2002}}) {
    const auto answer =
        synthesis::exact_certificate(equal_springs(passes), kDelta, latency, kPeriod);
    ASSERT_TRUE(answer.P) << latency << ": " << answer.why;
    EXPECT_EQ(answer.P->rows(), latency == 0 ? 5 : 8);
    EXPECT_TRUE(
        check::proves_exact(equal_springs(passes), kDelta, latency, kPeriod, *answer.P).holds);
    EXPECT_FALSE(
        check::proves_exact(equal_springs(fails), kDelta, latency, kPeriod, *answer.P).holds);
    EXPECT_FALSE(synthesis::exact_certificate(equal_springs(fails), kDelta, latency, kPeriod).P);
  }
}

TEST(ExactCertificate, ExistsIffTheSweepSaysPassive) {
  for (const double latency : {0.0, 0.3e-3, 1e-3, 1.6e-3, 3e-3}) {
    int passive = 0;
    for (const double stiffness : {50., 300., 800., 1500., 4000., 9000.}) {
      const System f = equal_springs(stiffness);
      const double margin = check::exact_margin(f, kDelta, latency, kPeriod);
      const auto answer = synthesis::exact_certificate(f, kDelta, latency, kPeriod);
      EXPECT_EQ(answer.P.has_value(), margin > 0)
          << latency << " s, " << stiffness << " N/m, margin " << margin << ": " << answer.why;
      passive += margin > 0;
    }
    EXPECT_GT(passive, 0);
    EXPECT_LT(passive, 6);
  }
}

TEST(ExactCertificate, RefusesWhatItCannotRead) {
  const System f = equal_springs(5000);
  const Matrix P = synthesis::exact_certificate(f, kDelta, 0, kPeriod).P.value();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto refused = [&](const System& scene, const Matrix& damping, double latency,
                           double period, const Matrix& p) {
    const check::Verdict verdict = check::proves_exact(scene, damping, latency, period, p);
    return !verdict.holds && !verdict.why.empty() && !(verdict.margin >= 0);
  };
  ASSERT_FALSE(refused(f, kDelta, 0, kPeriod, P));
  Matrix bad = P;
  bad(1, 1) = nan;
  EXPECT_TRUE(refused(f, kDelta, 0, kPeriod, bad));
  bad = P;
  bad(0, 1) += 1e-6 * std::sqrt(P(0, 0) * P(1, 1));
  EXPECT_TRUE(refused(f, kDelta, 0, kPeriod, bad)) << "asymmetric";
  EXPECT_TRUE(refused(f, kDelta, 0, kPeriod, P.topLeftCorner(4, 4)));
  EXPECT_TRUE(refused(f, kDelta, 0, kPeriod, -P));
  EXPECT_TRUE(refused(f, kDelta, 0, kPeriod, Matrix()));
  EXPECT_TRUE(refused(f, kDelta, 0, nan, P));
  EXPECT_TRUE(refused(f, kDelta, nan, kPeriod, P));
  EXPECT_TRUE(refused(f, kDelta, -1e-4, kPeriod, P));
  EXPECT_TRUE(refused(f, nan * kDelta, 0, kPeriod, P));
  EXPECT_TRUE(refused(f, -kDelta, 0, kPeriod, P));
  System odd = f;
  odd.A(0, 0) = nan;
  EXPECT_TRUE(refused(odd, kDelta, 0, kPeriod, P));
  odd = f;
  odd.C.conservativeResize(2, Eigen::NoChange);
  EXPECT_TRUE(refused(odd, kDelta, 0, kPeriod, P));
  odd = f;
  odd.D(0, 1) += 1;
  EXPECT_TRUE(refused(odd, kDelta, 0, kPeriod, P)) << "F(1) is not symmetric";
}

TEST(ExactPassivity, UnstableSceneIsNeverPassive) {
  System f = check::constant(Matrix::Constant(1, 1, 10.0));
  f.A = Matrix::Constant(1, 1, 1.01);
  f.B = f.C = Matrix::Constant(1, 1, 1e-3);
  const Matrix delta = Matrix::Constant(1, 1, 10.0);
  EXPECT_EQ(check::exact_margin(f, delta, 0, kPeriod), -std::numeric_limits<double>::infinity());
  EXPECT_FALSE(synthesis::exact_certificate(f, delta, 0, kPeriod).P);
  EXPECT_FALSE(check::proves_exact(f, delta, 0, kPeriod, Matrix::Identity(1, 1)).holds);
}

}  // namespace
}  // namespace hapticd::test
