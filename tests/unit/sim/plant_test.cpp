// The plant against closed forms that share nothing with its matrix exponential, and what friction
// may do.
#include "sim/plant.h"

#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <rapidcheck/gtest.h>

#include <cmath>

#include "tests/support/generators.h"

namespace hapticd::sim {
namespace {

constexpr double kRelative = 1e-12;

void expect_close(double found, long double expected) {
  EXPECT_NEAR(found, static_cast<double>(expected),
              kRelative * std::abs(static_cast<double>(expected)));
}

Plant moving(const PlantOptions& options, double position_m, double velocity_m_s) {
  Plant plant(options, position_m);
  plant.set_velocity(velocity_m_s);
  return plant;
}

TEST(Plant, FreeMassUnderForceFollowsTheParabola) {
  for (const double h : {1e-6, 1e-4, 1e-3, 0.5}) {
    Plant plant = moving({.mass_kg = 0.25}, 0.01, -0.3);
    plant.advance(plant.propagator(h), {.force_N = 2});
    expect_close(plant.position_m(), 0.01L - 0.3L * h + 0.5L * 8 * h * h);
    expect_close(plant.velocity_m_s(), -0.3L + 8.0L * h);
  }
}

// v = w + (v0 - w) e^{-h/tau}, x = x0 + w h + (v0 - w) tau (1 - e^{-h/tau}), w = f/d, tau = M/d
TEST(Plant, DampedMassUnderForceFollowsTheExponential) {
  for (const double h : {1e-6, 1e-4, 1e-3, 0.05, 2.0}) {
    Plant plant = moving({.mass_kg = 0.01, .damping_Ns_m = 0.22}, 0.02, 1);
    plant.advance(plant.propagator(h), {.force_N = 0.5});
    const long double tau = 0.01L / 0.22L, w = 0.5L / 0.22L, decay = expm1l(-h / tau);
    expect_close(plant.position_m(), 0.02L + w * h - (1 - w) * tau * decay);
    expect_close(plant.velocity_m_s(), 1 + (1 - w) * decay);
  }
}

// From rest the whole motion is small: the coefficients themselves must be right, not only the sum.
TEST(Plant, DampedMassFromRestIsRightInEveryDigitOfAShortStep) {
  const double h = 1e-5;
  Plant plant({.mass_kg = 0.01, .damping_Ns_m = 0.22}, 0);
  plant.advance(plant.propagator(h), {.force_N = 0.5});
  const long double tau = 0.01L / 0.22L, w = 0.5L / 0.22L;
  const long double z = h / tau;
  // w tau (z + expm1(-z)) by its series, since the sum cancels
  long double series = 0, term = 1;
  for (int n = 1; n < 12; ++n) {
    term *= -z / n;
    if (n >= 2) series += term;
  }
  expect_close(plant.position_m(), w * tau * series);
  expect_close(plant.velocity_m_s(), -w * expm1l(-z));
}

struct Spring {
  long double mass, damping, stiffness;
  long double decay() const { return damping / (2 * mass); }
  long double omega() const { return sqrtl(stiffness / mass - decay() * decay()); }
};

// Underdamped: y = e^{-at} (y0 cos wt + (v0 + a y0)/w sin wt)
long double free_position(const Spring& s, long double y0, long double v0, long double t) {
  const long double a = s.decay(), w = s.omega();
  return expl(-a * t) * (y0 * cosl(w * t) + (v0 + a * y0) / w * sinl(w * t));
}
long double free_velocity(const Spring& s, long double y0, long double v0, long double t) {
  const long double a = s.decay(), w = s.omega();
  return expl(-a * t) * (v0 * cosl(w * t) - (a * v0 + (a * a + w * w) * y0) / w * sinl(w * t));
}

TEST(Plant, DampedSpringSwingsAboutTheDisplacedRest) {
  const Spring s{0.3L, 2, 450};
  for (const double h : {1e-4, 1e-3, 0.02, 0.31}) {
    Plant plant = moving({.mass_kg = 0.3, .damping_Ns_m = 2, .stiffness_N_m = 450}, 0.02, -0.4);
    plant.advance(plant.propagator(h), {.force_N = 3, .rest_m = 0.05});
    const long double centre = 0.05L + 3 / s.stiffness;
    expect_close(plant.position_m(), centre + free_position(s, 0.02L - centre, -0.4L, h));
    expect_close(plant.velocity_m_s(), free_velocity(s, 0.02L - centre, -0.4L, h));
  }
}

// A rest that moves at r': y lags it by d r'/k for good, and swings about that.
TEST(Plant, SpringFollowsARestThatMovesLinearly) {
  const Spring s{0.3L, 2, 450};
  for (const double h : {1e-4, 1e-3, 0.02, 0.31}) {
    Plant plant = moving({.mass_kg = 0.3, .damping_Ns_m = 2, .stiffness_N_m = 450}, 0.02, -0.4);
    plant.advance(plant.propagator(h), {.rest_m = 0.05, .rest_rate_m_s = 0.7});
    const long double lag = s.damping * 0.7L / s.stiffness;
    const long double y0 = 0.02L - 0.05L + lag, v0 = -0.4L - 0.7L;
    expect_close(plant.position_m(), 0.05L + 0.7L * h - lag + free_position(s, y0, v0, h));
    expect_close(plant.velocity_m_s(), 0.7L + free_velocity(s, y0, v0, h));
  }
}

// y = y0 (r2 e^{r1 t} - r1 e^{r2 t}) / (r2 - r1) from rest, with the two real roots r1, r2 of M r^2
// + d r + k.
TEST(Plant, OverdampedStiffHandSettlesWithoutSwinging) {
  const long double mass = 0.01L, damping = 500, stiffness = 1000;
  const long double fast =
      -(damping + sqrtl(damping * damping - 4 * mass * stiffness)) / (2 * mass);
  const long double slow = stiffness / mass / fast;
  for (const double h : {1e-6, 1e-4, 1e-3, 0.5, 10.0}) {
    Plant plant({.mass_kg = 0.01, .damping_Ns_m = 500, .stiffness_N_m = 1000}, 0.01);
    plant.advance(plant.propagator(h), {});
    const long double y = 0.01L * (fast * expl(slow * h) - slow * expl(fast * h)) / (fast - slow);
    EXPECT_NEAR(plant.position_m(), static_cast<double>(y), 0.01 * kRelative);
  }
}

TEST(Plant, OneIntervalIsTheSumOfItsParts) {
  const PlantOptions options{.mass_kg = 0.05, .damping_Ns_m = 1.4, .stiffness_N_m = 300};
  Plant whole = moving(options, 0.01, 0.2);
  whole.advance(whole.propagator(1e-3), {.force_N = -1, .rest_m = 0.02, .rest_rate_m_s = 0.3});
  Plant parts = moving(options, 0.01, 0.2);
  parts.advance(parts.propagator(0.37e-3), {.force_N = -1, .rest_m = 0.02, .rest_rate_m_s = 0.3});
  const double rest_m = 0.02 + 0.3 * 0.37e-3;
  parts.advance(parts.propagator(0.63e-3), {.force_N = -1, .rest_m = rest_m, .rest_rate_m_s = 0.3});
  expect_close(parts.position_m(), whole.position_m());
  expect_close(parts.velocity_m_s(), whole.velocity_m_s());
}

TEST(Friction, StopsAMovingMassWhereCoulombSaysAndKeepsIt) {
  Plant plant = moving({.mass_kg = 0.1, .coulomb_N = 0.5}, 0, 0.2);
  const Propagator substep = plant.propagator(1e-4);
  double last_m_s = 0.2;
  for (int i = 0; i < 1000; ++i) {
    plant.advance(substep, {});
    ASSERT_GE(plant.velocity_m_s(), 0) << "turned round";
    ASSERT_LE(plant.velocity_m_s(), last_m_s);
    last_m_s = plant.velocity_m_s();
  }
  EXPECT_EQ(plant.velocity_m_s(), 0);
  EXPECT_NEAR(plant.position_m(), 0.1 * 0.2 * 0.2 / (2 * 0.5), 1e-6);  // M v^2 / 2F
}

TEST(Friction, HoldsExactlyUpToItsForceAndGivesWayBeyond) {
  // At zero the least creep would show.
  Plant plant({.mass_kg = 0.1, .damping_Ns_m = 1, .stiffness_N_m = 300, .coulomb_N = 0.5}, 0);
  const Propagator substep = plant.propagator(1e-4);
  for (const double force_N : {0.5, 0.37, -0.1, -0.5}) {
    for (int i = 0; i < 1000; ++i) plant.advance(substep, {.force_N = force_N});
    EXPECT_EQ(plant.position_m(), 0);
    EXPECT_EQ(plant.velocity_m_s(), 0);
  }
  plant.advance(substep, {.force_N = 0.51});
  // Only what is beyond the Coulomb force accelerates.
  EXPECT_NEAR(plant.velocity_m_s(), 0.01 / 0.1 * 1e-4, 1e-8);
}

TEST(Friction, LetsGoWithinAnIntervalInWhichTheHandPullsHarder) {
  Plant plant({.mass_kg = 0.1, .stiffness_N_m = 300, .coulomb_N = 0.5}, 0);
  plant.advance(plant.propagator(1e-3), {.rest_rate_m_s = 1});
  EXPECT_EQ(plant.velocity_m_s(), 0) << "0.3 N at the end: held";
  plant.advance(plant.propagator(1e-3), {.rest_m = 0.001, .rest_rate_m_s = 2});
  EXPECT_GT(plant.velocity_m_s(), 0) << "0.9 N at the end";
}

TEST(Friction, SlowsASlidingMassByItsForce) {
  Plant plant = moving({.mass_kg = 0.1, .coulomb_N = 0.5}, 0, -3);
  plant.advance(plant.propagator(1e-3), {.force_N = 2});
  EXPECT_NEAR(plant.velocity_m_s(), -3 + (2 + 0.5) / 0.1 * 1e-3, 1e-12);
}

// What the plant holds grows by no more than the work of the forces on it: no friction, damper or
// rounding adds to it.
RC_GTEST_PROP(Friction, NeverAddsEnergy, ()) {
  const double mass = test::any_number(0.01, 1), stiffness = test::any_number(0, 2000);
  Plant plant = moving({.mass_kg = mass,
                        .damping_Ns_m = test::any_number(0, 2),
                        .stiffness_N_m = stiffness,
                        .coulomb_N = test::any_number(0, 2)},
                       test::any_number(-0.01, 0.01), test::any_number(-1, 1));
  const Propagator substep = plant.propagator(1e-4);
  for (int i = 0; i < 500; ++i) {
    const double force_N = test::any_number(-2, 2);
    const double before_J = plant.energy_J(0), before_m = plant.position_m();
    plant.advance(substep, {.force_N = force_N});
    const double work_J = force_N * (plant.position_m() - before_m);
    RC_ASSERT(plant.energy_J(0) <=
              before_J + work_J + 1e-13 * (before_J + std::abs(work_J)) + 1e-18);
  }
}

}  // namespace
}  // namespace hapticd::sim
