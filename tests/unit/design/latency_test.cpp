#include "control/design/check/latency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "control/design/check/exact.h"
#include "control/design/check/spring_damper.h"
#include "control/design/synthesis/exact_certificate.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

Matrix one(double value) {
  return Matrix::Constant(1, 1, value);
}

struct TableRow {
  double periods, need;  ///< latency / T, damping / (K T)
};
constexpr TableRow kSpringTable[] = {{0, .5},  {.25, .808},  {.5, 1.059}, {.75, 1.286},
                                     {1, 1.5}, {1.5, 2.031}, {2, 2.5}};

TEST(SpringWithLatency, NeedsTheTabulatedDampingBySweepFormulaAndCertificate) {
  const double K = 1000;
  for (const auto& [periods, need] : kSpringTable) {
    const double latency = periods * kPeriod;
    const double damping = check::spring_needs_damping(K, latency, kPeriod);
    EXPECT_NEAR(damping / (K * kPeriod), need, 5.1e-4);
    const System spring = check::constant(one(K));
    EXPECT_GT(check::exact_margin(spring, one(damping * (1 + 1e-6)), latency, kPeriod), 0);
    EXPECT_LT(check::exact_margin(spring, one(damping * (1 - 1e-6)), latency, kPeriod), 0);
    EXPECT_TRUE(synthesis::exact_certificate(spring, one(damping * 1.0001), latency, kPeriod).P);
    EXPECT_FALSE(synthesis::exact_certificate(spring, one(damping * 0.9999), latency, kPeriod).P);
  }
}

TEST(PassiveScenes, ClosedFormIsTheSweepsAndTheCertificates) {
  std::mt19937 random(7);
  std::uniform_real_distribution<> uniform(0, 1);
  for (int i = 0; i < 60; ++i) {
    const double K = 100 + 5000 * uniform(random), B = 2 * uniform(random) * (i % 4),
                 latency = (i % 5 == 0   ? 0
                            : i % 5 == 1 ? 1
                                         : uniform(random)) *
                           kPeriod;
    const double need = check::passive_scene_needs_damping(K, B, latency, kPeriod);
    const System v = check::spring_damper(one(K), one(B), kPeriod);
    const auto margin = [&](double damping) {
      return check::passive_scene_margin(v, one(damping), latency, kPeriod);
    };
    EXPECT_GT(margin(need * (1 + 1e-6)), 0) << K << ' ' << B << ' ' << latency;
    EXPECT_LT(margin(need * (1 - 1e-6)), 0) << K << ' ' << B << ' ' << latency;
    const auto provable = [&](double damping) {
      const auto premises = check::passive_scene_premises(v, one(damping), latency, kPeriod);
      const auto answer = synthesis::find_storage(premises);
      return answer.P &&
             check::proves_passive_scenes(v, one(damping), latency, kPeriod, *answer.P).holds;
    };
    EXPECT_TRUE(provable(need * 1.001)) << K << ' ' << B << ' ' << latency;
    EXPECT_FALSE(provable(need * 0.999)) << K << ' ' << B << ' ' << latency;
  }
}

TEST(PassiveScenes, SpringsNeedThreeHalvesOfTheLatency) {
  for (const double periods : {0.0, 0.2, 0.5, 1.0})
    EXPECT_NEAR(check::passive_scene_needs_damping(1, 0, periods, 1), 0.5 * (1 + 3 * periods),
                1e-12);
}

TEST(PassiveScenes, SomeDampingHelpsWhereThereIsLatency) {
  EXPECT_NEAR(check::passive_scene_needs_damping(1, 0.3, 0.5, 1), 0.872, 5e-4);
  EXPECT_GT(check::passive_scene_needs_damping(1, 0.3, 0, 1),
            check::passive_scene_needs_damping(1, 0, 0, 1));
}

TEST(PassiveScenes, SweepGoesOnBeyondAPeriodWhereOneAxisHasALimitAtRest) {
  // B = 0, at rest: Delta > (K/2) (T (n+1)^2 + t (2 n + 3)).
  const double K = 200, T = kPeriod, t = 0.3e-3;
  const double need = 0.5 * K * (9 * T + t * 7);
  const System v = check::constant(one(1 / K));
  EXPECT_GT(check::passive_scene_margin(v, one(need * (1 + 1e-6)), 2 * T + t, T), 0);
  EXPECT_LT(check::passive_scene_margin(v, one(need * (1 - 1e-6)), 2 * T + t, T), 0);
}

/// exp(A), scaled Taylor series.
Matrix exponential(const Matrix& a) {
  const int halvings = 10;
  const Matrix small = a / std::exp2(halvings);
  Matrix sum = identity(a.rows()), term = sum;
  for (int i = 1; i < 14; ++i) sum += term = term * small / i;
  for (int i = 0; i < halvings; ++i) sum = sum * sum;
  return sum;
}

/// Spectral radius of one period, exactly. `a`: states of device and hand in continuous time, the
/// device's displacement first, the force of the wall (stiffness K) last and held; it arrives `late`.
double radius(const Matrix& a, double K, double late) {
  const Index n = a.rows();
  Matrix renewed = identity(n);
  renewed(n - 1, n - 1) = 0;
  Matrix sampled = Matrix::Zero(n, n);
  sampled(n - 1, 0) = K;
  Matrix step = exponential(a * (kPeriod - late)) * (renewed * exponential(a * late) + sampled);
  step.row(n - 1) = sampled.row(n - 1);
  return check::spectral_radius(step);
}

/// The device's mass in a hand that is that mass alone.
Matrix in_the_open(double mass) {
  Matrix a = Matrix::Zero(3, 3);
  a.topRows(2) << 0, 1, 0, 0, -kDamping / mass, -1 / mass;
  return a;
}

/// The hand is a mass on a spring that swings with the device's at `mode` radians a period.
Matrix with_swinging_hand(double mass, double hand, double mode) {
  const double tie = std::pow(mode / kPeriod, 2) / (1 / mass + 1 / hand);
  Matrix a = Matrix::Zero(5, 5);
  a.topRows(4) << 0, 1, 0, 0, 0, -tie / mass, -kDamping / mass, tie / mass, 0, -1 / mass,  //
      0, 0, 0, 1, 0, tie / hand, 0, -tie / hand, 0, 0;
  return a;
}

/// Is any of these hands, swinging near the sampling frequency, unstable?
bool seen_unstable(double K, double late) {
  for (const double mass : {0.1, 1.0})
    for (const double ratio : {16.0, 64.0, 256.0})
      for (double off = -0.04; off < 0.041; off += 0.004) {
        const double mode = 2 * 3.14159265358979 + off;
        if (radius(with_swinging_hand(mass, mass * ratio, mode), K, late) > 1 + 1e-9) return true;
      }
  return false;
}

TEST(SpringWithLatency, SmallestStiffnessSeenUnstableLiesAboveTheLargestAccepted) {
  const double late = 0.2e-3;
  EXPECT_GT(check::spring_needs_damping(2735, late, kPeriod), kDamping);
  const double accepted = kDamping / check::spring_needs_damping(1, late, kPeriod);
  double unstable = 0.98 * accepted;
  while (!seen_unstable(unstable, late)) unstable *= 1.005;
  EXPECT_GT(unstable, accepted);
  // Below what the rule K (T/2 + tau) < b would allow: that one is unsafe.
  EXPECT_LT(unstable, 0.99 * kDamping / (0.5 * kPeriod + late));
}

TEST(PassiveScenes, TheBoundIsTightAtARigidWall) {
  const auto accepted = [](double K) {
    return check::damping_share(one(K), one(0), one(kDamping), kPeriod) < 1;
  };
  EXPECT_TRUE(accepted(2735));
  EXPECT_FALSE(accepted(2745));
  double stable = 0, unstable = 0;
  for (double mass = 0.1; mass < 1e4; mass *= 2) {
    stable = std::max(stable, radius(in_the_open(mass), 2735, 0));
    unstable = std::max(unstable, radius(in_the_open(mass), 2745, 0));
  }
  EXPECT_LT(stable, 1);
  EXPECT_GT(unstable, 1);
}

}  // namespace
}  // namespace hapticd::test
