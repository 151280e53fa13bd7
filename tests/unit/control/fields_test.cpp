// Reference: differences of the energy and of the force, eigenvalues by Eigen, and a search for the
// steepest place.
#include "control/scene/fields.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <limits>
#include <numbers>
#include <random>

namespace hapticd::control {
namespace {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
const Vec3 kUnit[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

/// Slope of f along a direction, to h^6.
template <class F>
auto slope(const F& f, const Vec3& y, const Vec3& direction, double h) {
  const auto across = [&](double n) { return f(y + n * h * direction) - f(y - n * h * direction); };
  return (1 / (60 * h)) * (45 * across(1) + -9 * across(2) + across(3));
}

Eigen::Matrix3d matrix(const Mat3& m) {
  Eigen::Matrix3d out;
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      out(i, j) = m.row[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
  return out;
}

/// -d force / dy by differences.
template <class Field>
Eigen::Matrix3d hessian(const Field& field, const Vec3& y, double h) {
  Mat3 m;
  for (std::size_t j = 0; j < 3; ++j) {
    const Vec3 column =
        slope([&](const Vec3& at) { return evaluate(field, at).force; }, y, kUnit[j], h);
    for (std::size_t i = 0; i < 3; ++i) m.row[i][j] = -column[i];
  }
  return matrix(m);
}

/// A field's size [m] and strength [N], and how far around its centre it is looked at.
struct Scale {
  Vec3 centre;
  double length, force, reach;
};

Vec3 any_place(std::mt19937& random, const Scale& scale) {
  std::uniform_real_distribution<double> share(-1, 1);
  return scale.centre + scale.reach * Vec3{share(random), share(random), share(random)};
}

template <class Field>
void expect_potential(const Field& field, const Scale& scale) {
  std::mt19937 random(1);
  const double h = 1e-5 * scale.length;
  for (int n = 0; n < 400; ++n) {
    const Vec3 y = any_place(random, scale);
    const FieldValue value = evaluate(field, y);
    for (const Vec3& direction : kUnit) {
      const auto energy = [&](const Vec3& at) { return evaluate(field, at).energy; };
      // Across the edge, where the second derivative jumps, differences are right to h only.
      EXPECT_NEAR(dot(value.force, direction), -slope(energy, y, direction, h), 1e-5 * scale.force);
    }
  }
}

/// Places within 3 h of where the second derivative jumps are left out: `smooth(y)`.
template <class Field, class Smooth>
void expect_projected_hessian(const Field& field, const Scale& scale, Smooth smooth) {
  std::mt19937 random(2);
  int indefinite = 0;
  for (int n = 0; n < 400; ++n) {
    const Vec3 y = any_place(random, scale);
    if (!smooth(y)) continue;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(
        hessian(field, y, 1e-3 * scale.length));
    const Eigen::Matrix3d projected = eigen.eigenvectors() *
                                      eigen.eigenvalues().cwiseMax(0).asDiagonal() *
                                      eigen.eigenvectors().transpose();
    const double size = scale.force / scale.length;
    EXPECT_LT((matrix(evaluate(field, y).stiffness) - projected).norm(), 1e-6 * size);
    indefinite += eigen.eigenvalues()[0] < -0.01 * size && eigen.eigenvalues()[2] > 0.01 * size;
  }
  EXPECT_GT(indefinite, 20) << "the projection was put to the test";
}

/// Nowhere steeper than it says, and somewhere almost as steep.
template <class Field>
void expect_steepest(const Field& field, const Scale& scale) {
  std::mt19937 random(3);
  double found = 0;
  for (int n = 0; n < 200000; ++n) {
    const Eigen::Matrix3d m = matrix(evaluate(field, any_place(random, scale)).stiffness);
    found =
        std::max(found, Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(m, false).eigenvalues()[2]);
  }
  EXPECT_LE(found, steepest(field) * (1 + 1e-12));
  EXPECT_GT(found, steepest(field) * 0.9);
}

const ConstantField kConstant{.region = {.centre = {0.1, 0.2, 0.3}, .radius = 0.05},
                              .force = {1, -2, 2}};
const Scale kConstantScale{{0.1, 0.2, 0.3}, 0.05, 3, 0.055};

TEST(ConstantField, ForceIsThePotentialsSlope) {
  expect_potential(kConstant, kConstantScale);
}

TEST(ConstantField, StiffnessIsTheHessianWithoutItsNegativePart) {
  expect_projected_hessian(kConstant, kConstantScale, [](const Vec3& y) {
    return std::abs(norm(y - kConstant.region.centre) - 0.05) > 2e-4;
  });
}

TEST(ConstantField, IsNowhereSteeperThanItSays) {
  expect_steepest(kConstant, kConstantScale);
}

TEST(ConstantField, IsWholeInTheCentreFadesAndEndsWithoutAStep) {
  EXPECT_EQ(evaluate(kConstant, kConstant.region.centre).force, kConstant.force);
  const double half = 0.5 * 0.05 * std::sqrt(0.5);  // R / 2 off, at right angles to the force
  const Vec3 fading = evaluate(kConstant, kConstant.region.centre + Vec3{0, half, half}).force;
  EXPECT_LT(norm(fading - 0.5625 * kConstant.force), 1e-14);
  EXPECT_LT(norm(evaluate(kConstant, {0.1, 0.2, 0.35 - 1e-9}).force), 1e-6);
  EXPECT_EQ(evaluate(kConstant, {0.1, 0.2, 0.35 + 1e-9}).force, Vec3{});
}

TEST(ConstantField, WithoutRegionIsTheSameEverywhere) {
  const ConstantField field{.region = {.radius = kEverywhere}, .force = {0, 0, -1}};
  const FieldValue value = evaluate(field, {1e5, 3, 7});
  EXPECT_EQ(value.force, field.force);
  EXPECT_EQ(value.stiffness, Mat3{});
  EXPECT_EQ(value.energy, 7);
  EXPECT_EQ(steepest(field), 0);
}

const Detents kDetents{
    .along = {0.6, 0, 0.8}, .offset = 0.02, .spacing = 0.01, .max_force = 3, .count = 4};
const Scale kDetentsScale{{0.035 * 0.6, 0, 0.035 * 0.8}, 0.01, 3, 0.03};

TEST(Detents, ForceIsThePotentialsSlope) {
  expect_potential(kDetents, kDetentsScale);
}

TEST(Detents, AreNowhereSteeperThanTheySay) {
  expect_steepest(kDetents, kDetentsScale);
}

TEST(Detents, HoldAtEachPlaceAndPullBackToIt) {
  for (int place = 0; place < 4; ++place) {
    const auto at = [&](double off) {
      return evaluate(kDetents, (0.02 + 0.01 * place + off) * kDetents.along);
    };
    EXPECT_LT(norm(at(0).force), 1e-13);
    EXPECT_NEAR(dot(at(0.0025).force, kDetents.along), -3, 1e-12);
    EXPECT_NEAR(dot(at(-0.0025).force, kDetents.along), 3, 1e-12);
    EXPECT_NEAR(dot(kDetents.along, at(0).stiffness * kDetents.along), steepest(kDetents), 1e-9);
    EXPECT_EQ(at(0.004).stiffness, Mat3{}) << "past the steepest place it gets weaker";
  }
}

TEST(Detents, EndHalfASpacingBeyondTheFirstAndTheLast) {
  for (const double s : {0.02 - 0.0051, 0.05 + 0.0051, -1.0, 1e5}) {
    const FieldValue value = evaluate(kDetents, s * kDetents.along);
    EXPECT_EQ(value.force, Vec3{});
    EXPECT_NEAR(value.energy, 3 * 0.01 / std::numbers::pi, 1e-15);
  }
  Detents endless = kDetents;
  endless.count = 0;
  EXPECT_NEAR(norm(evaluate(endless, (0.02 - 77 * 0.01 + 0.0025) * endless.along).force), 3, 1e-10);
}

const Magnet kPointMagnet{.centre = {0.1, 0.2, 0.3}, .range = 0.05, .max_force = 2};
const Magnet kBallMagnet{.centre = {0.1, 0.2, 0.3}, .radius = 0.04, .range = 0.02, .max_force = 2};
const Scale kPointScale{{0.1, 0.2, 0.3}, 0.05, 2, 0.055};
const Scale kBallScale{{0.1, 0.2, 0.3}, 0.02, 2, 0.065};

TEST(Magnet, ForceIsThePotentialsSlope) {
  expect_potential(kPointMagnet, kPointScale);
  expect_potential(kBallMagnet, kBallScale);
}

TEST(Magnet, StiffnessIsTheHessianWithoutItsNegativePart) {
  expect_projected_hessian(kPointMagnet, kPointScale, [](const Vec3& y) {
    return std::abs(norm(y - kPointMagnet.centre) - 0.05) > 2e-4;
  });
  expect_projected_hessian(kBallMagnet, kBallScale, [](const Vec3& y) {
    return std::abs(std::abs(norm(y - kBallMagnet.centre) - 0.04) - 0.02) > 1e-4;
  });
}

TEST(Magnet, IsNowhereSteeperThanItSays) {
  expect_steepest(kPointMagnet, kPointScale);
  expect_steepest(kBallMagnet, kBallScale);
}

TEST(Magnet, PullsHardestAtAFixedShareOfItsRange) {
  double strongest = 0;
  for (double p = -0.02; p < 0.02; p += 1e-6) {
    const Vec3 force = evaluate(kBallMagnet, {0.1, 0.2 + 0.04 + p, 0.3}).force;
    strongest = std::max(strongest, norm(force));
    EXPECT_LE(force.y * p, 0) << "towards the surface from " << p;
  }
  EXPECT_NEAR(strongest, 2, 1e-8);
  EXPECT_NEAR(evaluate(kBallMagnet, {0.1, 0.24 + 0.02 / std::numbers::sqrt3, 0.3}).force.y, -2,
              1e-12);
}

TEST(Magnet, HasNoForceOnItsSurfaceInItsCentreAndOutOfRange) {
  EXPECT_LT(norm(evaluate(kBallMagnet, {0.1, 0.2, 0.34}).force), 1e-12);
  EXPECT_EQ(evaluate(kBallMagnet, {0.1, 0.2, 0.36}).energy, 0);
  EXPECT_EQ(evaluate(kBallMagnet, {0.1, 0.2, 0.31}).force, Vec3{});
  EXPECT_EQ(evaluate(kPointMagnet, kPointMagnet.centre).force, Vec3{});
  EXPECT_EQ(evaluate(kPointMagnet, kPointMagnet.centre).stiffness,
            diagonal(steepest(kPointMagnet)));
  Magnet wide = kBallMagnet;
  wide.range = 0.1;
  EXPECT_EQ(evaluate(wide, wide.centre).force, Vec3{});
}

TEST(ViscousField, ResistsMotionInsideItsRegionOnly) {
  const ViscousField honey{.region = {.centre = {0, 0, 1}, .radius = 0.1}, .damping = 4};
  const FieldValue in = evaluate(honey, {0, 0, 1.0999}, {1e-3, 0, -2e-3}, 1e-3);
  EXPECT_LT(norm(in.force - Vec3{-4, 0, 8}), 1e-14);
  EXPECT_EQ(in.stiffness, diagonal(4000));
  EXPECT_EQ(in.energy, 0);
  const FieldValue out = evaluate(honey, {0, 0, 1.1001}, {1e-3, 0, -2e-3}, 1e-3);
  EXPECT_EQ(out.force, Vec3{});
  EXPECT_EQ(out.stiffness, Mat3{});
}

TEST(Vibration, SwingsWithItsFrequencyAndPhase) {
  const Vibration buzz{.region = {.radius = kEverywhere},
                       .force = {0, 2, 0},
                       .frequency = 100,
                       .phase = std::numbers::pi / 6};
  EXPECT_NEAR(evaluate(buzz, {}, 0).force.y, 1, 1e-15);
  EXPECT_NEAR(evaluate(buzz, {}, 0.0025).force.y, std::sqrt(3.0), 1e-14);
  EXPECT_NEAR(evaluate(buzz, {}, 0.005).force.y, -1, 1e-14);
  EXPECT_NEAR(evaluate(buzz, {}, 86400.0).force.y, 1, 1e-9) << "after a day";
  Vibration local = buzz;
  local.region.radius = 0.1;
  EXPECT_EQ(evaluate(local, {0.2, 0, 0}, 0).force, Vec3{});
}

}  // namespace
}  // namespace hapticd::control
