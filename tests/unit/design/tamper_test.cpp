// Whoever changes a coupling or its certificate and keeps the claim is refused, or the claim still
// holds: of the check by Cholesky factors against oracles that know nothing of P.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "control/design/check/exact.h"
#include "control/design/check/positive_real.h"
#include "control/design/synthesis/exact_certificate.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

#ifdef HAPTICD_SANITIZED
constexpr int kChanges = 1000;
#else
constexpr int kChanges = 10'000;
#endif

/// A relative change of 1e-12 to 10, either sign, of one or several entries; symmetric.
void change(Matrix& m, std::mt19937_64& random) {
  std::uniform_real_distribution<double> exponent(-12, 1);
  std::uniform_int_distribution<Index> entry(0, m.rows() - 1);
  std::uniform_int_distribution<int> count(1, 3), coin(0, 1);
  for (int n = count(random); n > 0; --n) {
    const Index i = entry(random), j = entry(random);
    const double factor = std::pow(10.0, exponent(random)) * (coin(random) == 0 ? -1 : 1);
    m(i, j) += m(i, j) * factor;
    m(j, i) = m(i, j);
  }
}

struct Counts {
  int accepted = 0, refused = 0, wrong = 0;
};

TEST(Tampering, AChangedCouplingIsRefusedOrStillPassiveWithItsScene) {
  const Matrix delta = kDamping * identity(3);
  const Matrix K = 7000 * identity(3);
  const auto certificate =
      synthesis::exact_certificate(sprung(paper1_scene(), K), delta, 0, kPeriod);
  ASSERT_TRUE(certificate.P) << certificate.why;
  std::mt19937_64 random(20100712);
  Counts counts;
  for (int n = 0; n < kChanges; ++n) {
    Matrix changed_K = K, changed_P = *certificate.P;
    change(n % 2 == 0 ? changed_K : changed_P, random);
    const System f = sprung(paper1_scene(), changed_K);
    const check::Verdict verdict = check::proves_exact(f, delta, 0, kPeriod, changed_P);
    if (!verdict.holds) {
      ++counts.refused;
      EXPECT_FALSE(verdict.why.empty());
      continue;
    }
    ++counts.accepted;
    // The oracle is slow: where K is as it was it has nothing new to say.
    if (changed_K != K && n % 8 == 0 && !(check::exact_margin(f, delta, 0, kPeriod) > 0))
      ++counts.wrong;
  }
  EXPECT_EQ(counts.wrong, 0);
  EXPECT_GT(counts.accepted, kChanges / 20);
  EXPECT_GT(counts.refused, kChanges / 20);
}

TEST(Tampering, AStifferCouplingThanTheLimitIsNeverAccepted) {
  const Matrix delta = kDamping * identity(3);
  const double limit = paper1_reference().at("limits").at("sampled_data_passivity_K_max_B0_this_E");
  const auto certificate =
      synthesis::exact_certificate(sprung(paper1_scene(), 8700 * identity(3)), delta, 0, kPeriod);
  ASSERT_TRUE(certificate.P) << certificate.why;
  std::mt19937_64 random(7);
  const System beyond = sprung(paper1_scene(), (limit + 0.05) * identity(3));
  for (int n = 0; n < kChanges / 10; ++n) {
    Matrix P = *certificate.P;
    change(P, random);
    EXPECT_FALSE(check::proves_exact(beyond, delta, 0, kPeriod, P).holds);
  }
}

TEST(Tampering, AnotherRateLatencyDampingOrSceneIsRefused) {
  const Matrix delta = kDamping * identity(3);
  const System f = sprung(paper1_scene(), 8600 * identity(3));
  const auto certificate = synthesis::exact_certificate(f, delta, 0, kPeriod);
  ASSERT_TRUE(certificate.P) << certificate.why;
  const Matrix& P = *certificate.P;
  EXPECT_TRUE(check::proves_exact(f, delta, 0, kPeriod, P).holds);
  EXPECT_FALSE(check::proves_exact(f, delta, 0, 1.1 * kPeriod, P).holds);
  EXPECT_FALSE(check::proves_exact(f, delta, 1e-4, kPeriod, P).holds);
  EXPECT_FALSE(check::proves_exact(f, 0.97 * delta, 0, kPeriod, P).holds);
  System stiffer = paper1_scene();
  stiffer.C *= 1.2;
  stiffer.D *= 1.2;
  EXPECT_FALSE(
      check::proves_exact(sprung(stiffer, 8600 * identity(3)), delta, 0, kPeriod, P).holds);
}

}  // namespace
}  // namespace hapticd::test
