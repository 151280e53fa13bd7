// Scenes that are nearly convex: how far objects are from it, what level a coupling has for them,
// and the answer for magnets that are felt together with a network's masses.
#include "control/design/check/weak_convexity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "control/design/check/objects.h"
#include "control/design/check/positive_real.h"
#include "control/design/check/spring_damper.h"
#include "control/design/check/stability.h"
#include "tests/support/linear_systems.h"
#include "tests/support/networks.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::check {
namespace {

using control::ObjectKind;
using test::kPeriod;

/// Positive, of order one, in no direction alike.
Matrix any_positive(std::mt19937_64& random, Eigen::Index m) {
  std::uniform_real_distribution<double> number(-1, 1);
  const Matrix root = Matrix::NullaryExpr(m, m, [&] { return number(random); });
  return 0.5 * test::identity(m) + root * root.transpose();
}

double weakness_in(const build::ProgramSpec& spec) {
  const build::Program program(spec);
  bool convex = true;
  return objects_of(program.plan(), program.plan().contacts[0], convex).weakness;
}

Vec3 anywhere(std::mt19937_64& random, double reach) {
  std::uniform_real_distribution<double> place(-reach, reach);
  return {place(random), place(random), place(random)};
}

/// Largest rho that any of many pairs of points asks for: U(b) >= U(a) - F(a).d - rho/2 |d|^2.
/// Half the pairs are near each other.
template <typename Field>
double weakness_needed(const Field& at, double reach) {
  std::mt19937_64 random(20260);
  double most = 0;
  for (int n = 0; n < 200'000; ++n) {
    const Vec3 a = anywhere(random, reach);
    const Vec3 b = n % 2 == 0 ? anywhere(random, reach) : a + anywhere(random, 0.01 * reach);
    const Vec3 d = b - a;
    const control::FieldValue here = at(a), there = at(b);
    most = std::max(most, 2 * (here.energy - dot(here.force, d) - there.energy) / squared_norm(d));
  }
  return most;
}

TEST(WeakConvexity, OfDetentsIsTheirSlopeAndNotLess) {
  const control::Detents detents{{1, 0, 0}, 0.001, 0.01, 2, 3};
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.detents, ObjectKind::detents, detents);
  const double claimed = weakness_in(spec);
  const double found = weakness_needed([&](const Vec3& y) { return evaluate(detents, y); }, 0.03);
  EXPECT_LE(found, claimed * (1 + 1e-9));
  EXPECT_GE(found, claimed * 0.98);
}

TEST(WeakConvexity, OfMagnetsCoversAPointAndABall) {
  for (const double radius : {0.0, 0.011, 0.05}) {
    const control::Magnet magnet{{}, radius, 0.01, 3};
    build::ProgramSpec spec = test::scene_spec();
    test::add_object(spec, spec.magnets, ObjectKind::magnet, magnet);
    const double claimed = weakness_in(spec);
    const double found =
        weakness_needed([&](const Vec3& y) { return evaluate(magnet, y); }, radius + 0.012);
    EXPECT_LE(found, claimed * (1 + 1e-9)) << radius;
    EXPECT_GE(found, claimed * 0.45)
        << radius;  // looser where a ball is hardly wider than the range
  }
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.magnets, ObjectKind::magnet, control::Magnet{{}, 0.01, 0.02, 3});
  EXPECT_TRUE(std::isinf(weakness_in(spec)));
}

TEST(WeakConvexity, OfAConstantFieldThatFadesIsItsSlope) {
  const control::ConstantField field{{{}, 0.04}, {1, 2, -1}};
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.constant_fields, ObjectKind::constant, field);
  const double claimed = weakness_in(spec);
  const double found = weakness_needed([&](const Vec3& y) { return evaluate(field, y); }, 0.045);
  EXPECT_LE(found, claimed * (1 + 1e-9));
  EXPECT_GE(found, claimed * 0.6);
}

TEST(WeakConvexity, OfSeveralFieldsIsTheSum) {
  build::ProgramSpec spec = test::scene_spec();
  const control::Magnet near{{}, 0, 0.01, 3}, far{{0.5, 0, 0}, 0, 0.01, 3};
  test::add_object(spec, spec.magnets, ObjectKind::magnet, near);
  const double one = weakness_in(spec);
  test::add_object(spec, spec.magnets, ObjectKind::magnet, far);
  EXPECT_DOUBLE_EQ(weakness_in(spec), 2 * one);
}

TEST(WeakConvexity, OfBodiesThatAreNotConvexThereIsNone) {
  build::ProgramSpec spec = test::scene_spec();
  test::add_object(spec, spec.boxes, ObjectKind::box, control::Box{.half = {0.1, 0.1, 0.1}},
                   test::surface(1000));
  EXPECT_TRUE(std::isinf(weakness_in(spec)));
  spec = test::scene_spec();
  test::add_object(spec, spec.spheres, ObjectKind::sphere,
                   control::Sphere{{}, 0.05, control::Free::outside}, test::surface(1000));
  EXPECT_TRUE(std::isinf(weakness_in(spec)));
  spec.spheres[0].free = control::Free::inside;
  EXPECT_EQ(weakness_in(spec), 0);
}

TEST(WeakConvexity, ALevelOfSpringsAndDampersIsExact) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> decade(-1, 1);
  for (int n = 0; n < 40; ++n) {
    const Matrix damping = any_positive(random, 3),
                 K = 800 * any_positive(random, 3) * std::pow(10, decade(random));
    const Matrix B = std::pow(10, decade(random) - 1) * any_positive(random, 3);
    const Matrix level = spring_damper_level(K, B, damping, kPeriod);
    if (level.size() == 0) continue;
    const System backed =
        inverse(sum(spring_damper(K, B, kPeriod),
                    constant(-0.5 * kPeriod * test::identity(3) * damping.inverse())));
    EXPECT_NEAR(positive_real_margin(backed, -level, kPeriod) / level.norm(), 0, 1e-7);
  }
}

TEST(WeakConvexity, SpringsAreStifferThanTheSceneIsWeakAndSofterThanTheDamping) {
  const Matrix damping = 1.37 * test::identity(2);
  for (const double rho : {10.0, 400.0, 2700.0, 3000.0}) {
    for (const double k : {9.0, 11.0, 390.0, 410.0, 2690.0, 2710.0, 2739.0, 2741.0}) {
      const double share = share_with_level(
          k * test::identity(2), Matrix::Zero(2, 2), 0.5 * kPeriod * rho * test::identity(2),
          [&](double part) { return Matrix(part * damping); }, kPeriod);
      if (k <= rho) {
        EXPECT_TRUE(std::isinf(share)) << rho << ' ' << k;
      } else {
        EXPECT_NEAR(share, 0.5 * kPeriod * k / 1.37, 1e-8) << rho << ' ' << k;
      }
    }
  }
}

/// A magnet (or a box) and a mass on a spring, behind springs alike in all directions.
constexpr control::Magnet kMagnet{{}, 0.05, 0.01, 3};
constexpr double kWeak = 2 * 1.5 * std::numbers::sqrt3 * 3 / 0.01;  // N/m: 1558.8
build::ProgramSpec magnet_and_mass(double stiffness, bool box = false) {
  build::ProgramSpec spec = test::scene_spec();
  if (box) {
    test::add_object(spec, spec.boxes, ObjectKind::box, control::Box{.half = {0.05, 0.05, 0.05}},
                     test::surface(20'000));
  } else {
    test::add_object(spec, spec.magnets, ObjectKind::magnet, kMagnet);
  }
  build::Network network;
  for (std::uint32_t i = 0; i < 3; ++i) {
    network.nodes.push_back({.mass = 0.05, .position = i == 0 ? 0.07 : 0});
    network.elements.push_back(test::element(test::coordinate(i), test::node(i), 300, 0.02));
  }
  spec.networks = {network};
  spec.coupling = {test::spring_damper(0, {stiffness, stiffness, stiffness})};
  return spec;
}

PassiveAnswer answer_for(const build::ProgramSpec& spec, double damping) {
  const build::Program program(spec);
  return passive(program.plan(), {{.name = "left",
                                   .min_damping = {damping, damping, damping},
                                   .nonconvex = {"box 'lid'"},
                                   .heavy_network = true}})
      .at(0);
}

TEST(WeakConvexity, AMagnetBesideAMassIsProvedBetweenTwoBounds) {
  const auto yes = answer_for(magnet_and_mass(2000), 1.25);
  EXPECT_TRUE(yes.proved) << yes.why;
  EXPECT_EQ(yes.theorem, Theorem::passive_scene);
  EXPECT_NEAR(yes.damping_used, 0.8, 1e-6);
  EXPECT_TRUE(answer_for(magnet_and_mass(1.001 * kWeak), 1.25).proved);
  EXPECT_FALSE(answer_for(magnet_and_mass(0.999 * kWeak), 1.25).proved);
  EXPECT_FALSE(answer_for(magnet_and_mass(2000), 0.9999).proved);
  const auto no = answer_for(magnet_and_mass(2000, true), 1.25);
  EXPECT_FALSE(no.proved);
  EXPECT_NE(no.why.find("box 'lid' is not convex, nor nearly"), std::string::npos) << no.why;
  ASSERT_EQ(no.uncertified.size(), 1U);
}

/// Least of what hands have put into the loop and the device's damping has taken, along a path that
/// shakes about the magnet's range, from outside of it [J]; the loop is passive if it never falls
/// below what leaving the magnet takes, which is nothing where the path began.
double least_energy(double stiffness, double damping, unsigned seed) {
  test::SceneRig rig(magnet_and_mass(stiffness));
  std::mt19937_64 random(seed);
  std::normal_distribution<double> push(0, 1);
  Vec3 x{0.07, 0, 0}, v{};
  rig.start(x);
  // Inside the range the magnet's energy is lower than outside, by this much at most.
  const double depth = 3 * std::numbers::sqrt3 / 8 * kMagnet.max_force * kMagnet.range;
  double energy = depth, least = depth;
  for (int k = 0; k < 3000; ++k) {
    const Vec3 force = rig.at(x);
    v = -0.9 * v + Vec3{0.1 * push(random), 0.1 * push(random), 0.1 * push(random)};
    v += (-20 * (1 - 0.056 / norm(x))) * x;
    const Vec3 step = kPeriod * v;
    energy += -dot(force, step) + damping / kPeriod * squared_norm(step);
    least = std::min(least, energy);
    x += step;
  }
  return least;
}

TEST(WeakConvexity, NoPathTakesEnergyOutOfWhatIsProved) {
  double proved = 1, refused = 1;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    proved = std::min(proved, least_energy(2000, 1.001, seed));
    refused = std::min(refused, least_energy(2000, 0.1, seed));
  }
  EXPECT_GE(proved, -1e-12);
  EXPECT_LT(refused, -1e-5);
}

}  // namespace
}  // namespace hapticd::check
