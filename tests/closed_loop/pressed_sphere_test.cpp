// A hand of half a kilogram presses with a spring on a rigid sphere, where the way back to the top
// is unstable: the coupling must not feed the motion. The device's damping of 1.37 N s/m at 1 kHz
// carries 2740 N/m.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/scene_fixture.h"

namespace hapticd::test {
namespace {

/// Speed of the hand [m/s], largest of the last second, after 60 s.
double late_speed(double stiffness, const control::Surface& feel) {
  constexpr double kMass = 0.5, kHand = 50, kDamping = 1.37, kRadius = 0.05;
  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.spheres, control::ObjectKind::sphere,
             control::Sphere{{}, kRadius, control::Free::outside}, feel);
  spec.coupling = {spring_damper(0, {stiffness, stiffness, stiffness})};
  SceneRig rig(std::move(spec));
  // Each direction is a mass, a spring and a damper: exact over a tick with the force held.
  const double decay = kDamping / (2 * kMass), period = rig.program.plan().period_s;
  const double swing = std::sqrt(kHand / kMass - decay * decay);
  const double e = std::exp(-decay * period), c = std::cos(swing * period),
               s = std::sin(swing * period) / swing;
  Vec3 x{0, kRadius, 0}, v{0.05, 0, 0};
  rig.start(x);
  double fastest = 0;
  for (int tick = 0; tick < 60000; ++tick) {
    const Vec3 rest = (1 / kHand) * rig.at(x);  // the hand's spring is slack at the origin
    const Vec3 off = x - rest;
    x = rest + e * ((c + decay * s) * off + s * v);
    v = e * ((c - decay * s) * v - (s * kHand / kMass) * off);
    if (tick >= 59000) fastest = std::max(fastest, norm(v));
  }
  return fastest;
}

TEST(PressedSphere, ComesToRestWhereTheCertificateHolds) {
  EXPECT_LT(late_speed(2600, rigid()), 0.005);
  EXPECT_LT(late_speed(2700, rigid()), 0.02);
  EXPECT_LT(late_speed(2700, surface(20000)), 0.02);
  EXPECT_LT(late_speed(2700, surface(1000)), 0.02);
}

TEST(PressedSphere, ShakesForEverBeyondIt) {
  EXPECT_GT(late_speed(2900, rigid()), 0.03);
}

}  // namespace
}  // namespace hapticd::test
