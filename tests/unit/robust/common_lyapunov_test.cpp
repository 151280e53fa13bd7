// Proofs that one loop, or a box of them, is stable by quadratic Lyapunov functions: what they cover
// holds when it is looked at loop by loop, and what does not hold is never proved.
#include "control/design/check/common_lyapunov.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

#include "control/design/check/robust.h"
#include "control/design/synthesis/balance.h"
#include "control/design/synthesis/common_search.h"
#include "tests/support/paper2_loop.h"

namespace hapticd::test {
namespace {

using check::LoopBox;
using check::LoopCase;
using check::Robust;
using check::SampledLoop;

const LoopBox kHalfBox{.mass_kg = {0.005, 0.015}, .damping_Ns_m = {0.011, 0.033}};

SampledLoop bilateral_wall(double damper) {
  return loop_of(paper2_wall(), damper);
}

LoopCase drawn_from(const LoopBox& box, std::mt19937& random) {
  std::uniform_real_distribution<double> one(0, 1);
  const auto in = [&](const check::Side& side) {
    // Ends and what is between.
    const double share = one(random) < 0.2 ? 0 : one(random) < 0.25 ? 1 : one(random);
    return side.low + share * (side.high - side.low);
  };
  return {.mass_kg = in(box.mass_kg),
          .damping_Ns_m = in(box.damping_Ns_m),
          .hand_kg = in(box.hand_kg),
          .hand_Ns_m = in(box.hand_Ns_m),
          .hand_N_m = in(box.hand_N_m),
          .latency_s = in(box.latency_s),
          .contact = in(box.contact)};
}

/// Largest |A z|_P / |z|_P.
double contraction(const SampledLoop& loop, const LoopCase& one, const Matrix& P) {
  const Matrix a = check::transition(loop, one, 1);
  return std::sqrt(Eigen::GeneralizedSelfAdjointEigenSolver<Matrix>(
                       check::symmetric_part(a.transpose() * P * a), P, Eigen::EigenvaluesOnly)
                       .eigenvalues()
                       .maxCoeff());
}

TEST(CommonLyapunov, OneFunctionForAllDevicesOfThePapersBox) {
  const SampledLoop loop = bilateral_wall(5);
  const auto found = synthesis::find_common(loop, kHalfBox);
  ASSERT_EQ(found.P.size(), 1u) << found.why;
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial)
    EXPECT_LT(contraction(loop, drawn_from(kHalfBox, random), found.P[0]), 1);
  const check::RobustAnswer answer = check::robust(loop, kHalfBox, found.P);
  EXPECT_EQ(answer.kind, Robust::proved) << answer.why;
  EXPECT_NE(answer.why.find("1 quadratic Lyapunov function,"), std::string::npos);
}

TEST(CommonLyapunov, LatencyAndContactMayChangeWithEveryTick) {
  LoopBox box{.mass_kg = {0.05, 0.06},
              .damping_Ns_m = {1, 2},
              .hand_kg = {0, 0.02},
              .hand_Ns_m = {2, 4},
              .hand_N_m = {200, 300},
              .latency_s = {0, 200e-6},
              .contact = {0, 1}};
  synthesis::SampledWall wall = paper2_wall();
  wall.stiffness_N_m = 200;
  const SampledLoop loop = loop_of(wall, 2);
  const auto found = synthesis::find_common(loop, box);
  ASSERT_EQ(found.P.size(), 1u) << found.why;
  std::mt19937 random(2);
  // A walk through the box, another loop at every tick, never rises in P.
  Vector z = Vector::Random(found.P[0].rows());
  double energy = z.dot(found.P[0] * z);
  for (int tick = 0; tick < 500; ++tick) {
    z = (check::transition(loop, drawn_from(box, random), 1) * z).eval();
    const double next = z.dot(found.P[0] * z);
    EXPECT_LT(next, energy);
    energy = next;
  }
}

TEST(CommonLyapunov, WhatIsProvedHoldsForEveryLoopOfTheBox) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> one(0, 1);
  int proved = 0, refused = 0;
  for (int trial = 0; trial < 120; ++trial) {
    const double wide = std::pow(10, -4 * one(random));
    const auto side = [&](double low) { return check::Side{low, low * (1 + wide)}; };
    LoopBox box{.mass_kg = side(0.004 + 0.05 * one(random)),
                .damping_Ns_m = side(0.01 + one(random)),
                .hand_N_m = side(300 * one(random)),
                .latency_s = side(300e-6 * one(random)),
                .contact = {1 - 0.5 * wide, 1}};
    const SampledLoop loop = bilateral_wall(1 + 8 * one(random));
    // A function that suits some loop of the box, not all of it.
    const Matrix a = check::transition(loop, drawn_from(box, random), 1);
    if (!(check::spectral_radius(a) < 1)) continue;
    const Vector unit = (Vector(5) << 1e3, 1, 1e3, 1, 1).finished().head(a.rows());
    const Matrix weight = unit.cwiseAbs2().asDiagonal();
    const Matrix P = synthesis::discrete_lyapunov(a.transpose(), weight);
    const bool holds = check::proves_common(loop, box, P).holds;
    double worst = 0;
    for (int point = 0; point < 60; ++point)
      worst = std::max(worst, contraction(loop, drawn_from(box, random), P));
    if (holds) {
      EXPECT_LT(worst, 1) << trial;
    }
    ++(holds ? proved : refused);
  }
  EXPECT_GT(proved, 30);
  EXPECT_GT(refused, 30);
}

// A daemon that reloads waits for the check: what would take long is not begun.
TEST(CommonLyapunov, ALoopOfTooManyStatesIsNotLookedAt) {
  check::SampledLoop loop = bilateral_wall(5);
  check::System large;
  large.A = 0.5 * Matrix::Identity(40, 40);
  large.B = Matrix::Ones(40, 2);
  large.C = Matrix::Zero(1, 40);
  large.D = loop.force.D;
  loop.force = large;
  EXPECT_NE(check::unfit(loop, kHalfBox, {}).find("states"), std::string::npos);
  EXPECT_EQ(check::unfit(bilateral_wall(5), kHalfBox, {}), "");
}

TEST(CommonLyapunov, RefusesAFunctionThatDoesNotFit) {
  const SampledLoop loop = bilateral_wall(5);
  const Matrix P = synthesis::find_common(loop, kHalfBox).P.at(0);
  ASSERT_TRUE(check::proves_common(loop, kHalfBox, P).holds);
  EXPECT_FALSE(check::proves_common(bilateral_wall(9.5), kHalfBox, P).holds);
  LoopBox wider = kHalfBox;
  wider.mass_kg.low = 0.0024;  // not stable
  EXPECT_FALSE(check::proves_common(loop, wider, P).holds);
  Matrix tampered = P;
  tampered(0, 0) *= 0.5;
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, tampered).holds);
  tampered = P;
  tampered(0, 1) *= 1 + 1e-6;
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, tampered).holds);  // not symmetric
  tampered = P;
  tampered(1, 1) = std::nan("");
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, tampered).holds);
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, -P).holds);
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, Matrix::Identity(4, 4)).holds);
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, Matrix::Identity(5, 5)).holds);
  EXPECT_FALSE(check::proves_common(loop, kHalfBox, P, 2).holds);  // too few cells
}

TEST(CommonLyapunov, DevicesThatDoNotChangeAreProvedAlmostToTheExactLimit) {
  // Stable up to 8.957 for every one of them, and one function does for none above about 6.
  const SampledLoop loop = bilateral_wall(8.8);
  EXPECT_TRUE(synthesis::find_common(loop, kHalfBox).P.empty());
  const auto found = synthesis::find_constant(loop, kHalfBox);
  ASSERT_GT(found.P.size(), 1u) << found.why;
  const check::RobustAnswer answer = check::robust(loop, kHalfBox, found.P);
  EXPECT_EQ(answer.kind, Robust::proved_constant) << answer.why;
  EXPECT_NE(answer.why.find("quadratic Lyapunov functions"), std::string::npos);
  // Not with one of them missing.
  const std::vector<Matrix> fewer(found.P.begin(), found.P.end() - 1);
  EXPECT_EQ(check::robust(loop, kHalfBox, fewer).kind, Robust::sampled);
  EXPECT_TRUE(synthesis::find_constant(bilateral_wall(9.2), kHalfBox).P.empty());
}

TEST(Robust, SaysWhichCaseFailsAndHowManyWereTried) {
  const check::RobustAnswer no = check::robust(bilateral_wall(15), kHalfBox);
  EXPECT_EQ(no.kind, Robust::no);
  EXPECT_EQ(no.worst.at.mass_kg, 0.005);
  // The damping hardly matters: the reference has 0.011 N s/m.
  EXPECT_NEAR(no.worst.radius, std::hypot(0.26867007, 1.23591797), 1e-6);
  EXPECT_NE(no.why.find("mass 0.005 kg"), std::string::npos) << no.why;
  const check::RobustAnswer sampled = check::robust(bilateral_wall(5), kHalfBox);
  EXPECT_EQ(sampled.kind, Robust::sampled);
  EXPECT_EQ(sampled.cases, 9u);
  EXPECT_NE(sampled.why.find("9 cases; largest eigenvalue"), std::string::npos) << sampled.why;
}

TEST(Robust, NeverProvesWhatItsPremisesDoNotCover) {
  LoopBox open = kHalfBox;
  open.contact = {0, 1};
  EXPECT_TRUE(synthesis::find_common(bilateral_wall(5), open).P.empty());
  LoopBox late = kHalfBox;
  late.latency_s = {0, 1.5e-3};
  EXPECT_FALSE(check::excluded(bilateral_wall(5), late).empty());
  EXPECT_TRUE(synthesis::find_constant(bilateral_wall(5), late).P.empty());
  synthesis::SampledWall wall = paper2_wall();
  wall.observer = build::observer(0, 0,
                                  {.mode = build::ObserverMode::sensor,
                                   .nominal_mass_kg = 0.01,
                                   .cutoff_Hz = 5,
                                   .max_output = 1e9},
                                  kPeriod_s);
  EXPECT_FALSE(check::excluded(loop_of(wall, 5), kHalfBox).empty());
  LoopBox empty = kHalfBox;
  empty.mass_kg = {0.015, 0.005};
  EXPECT_EQ(check::robust(bilateral_wall(5), empty).kind, Robust::no);
  empty.mass_kg = {std::nan(""), std::nan("")};
  EXPECT_EQ(check::robust(bilateral_wall(5), empty).kind, Robust::no);
}

TEST(Robust, WithAClassicObserverAndAHandThatIsLightEnough) {
  synthesis::SampledWall wall = paper2_wall();
  wall.observer = build::observer(0, 0,
                                  {.mode = build::ObserverMode::classic,
                                   .nominal_mass_kg = 0.01,
                                   .nominal_damping_Ns_m = 0.022,
                                   .cutoff_Hz = 5,
                                   .max_output = 1e9},
                                  kPeriod_s);
  LoopBox box{.mass_kg = {0.008, 0.012}, .damping_Ns_m = {0.022, 0.022}, .hand_kg = {0, 0.03}};
  const SampledLoop loop = loop_of(wall, 5);
  const auto found = synthesis::find_constant(loop, box);
  EXPECT_EQ(check::robust(loop, box, found.P).kind, Robust::proved_constant) << found.why;
  box.hand_kg = {0, 1};
  const check::RobustAnswer heavy = check::robust(loop, box);
  EXPECT_EQ(heavy.kind, Robust::no);
  EXPECT_NE(heavy.why.find("hand 1 kg"), std::string::npos) << heavy.why;
}

}  // namespace
}  // namespace hapticd::test
