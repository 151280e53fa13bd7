// What other haptic software was seen to get wrong, and what scenes must not depend on: units,
// place, order.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/support/program_fixture.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::test {
namespace {

using control::Free;
using control::ObjectKind;

void expect_point(const Vec3& found, const Vec3& wanted, double tolerance) {
  EXPECT_NEAR(found.x, wanted.x, tolerance);
  EXPECT_NEAR(found.y, wanted.y, tolerance);
  EXPECT_NEAR(found.z, wanted.z, tolerance);
}

/// A sphere through a coupling on the loop's own first device, as TickInput drives it.
build::ProgramSpec loop_spec(bool coupled) {
  build::ProgramSpec spec = spec_of(3);
  spec.devices[0].max_force = 6;
  for (control::AxisPlan& axis : spec.axes) axis.max_step = 0.02;
  spec.contacts = {{.coordinates = 3, .direction = {0, 1, 2}, .max_force = 6}};
  add_object(spec, spec.spheres, ObjectKind::sphere, control::Sphere{{}, 0.05, Free::outside},
             surface(1000));
  if (coupled) spec.coupling = {spring_damper(0, {800, 800, 800})};
  return spec;
}

class Failures : public testing::TestWithParam<bool> {};

TEST_P(Failures, ANaNTickCostsNoContact) {
  Rig rig(loop_spec(GetParam()));
  rig.enable_at(0.048);
  const double before = rig.again().effort[0];
  ASSERT_GT(before, 0.5);
  rig.samples[0].raw = std::numeric_limits<double>::quiet_NaN();
  const control::TickOutput during = rig.run();
  EXPECT_TRUE(std::isfinite(during.effort[0]));
  EXPECT_LE(std::abs(during.effort[0]), before + 1e-12);
}

TEST_P(Failures, AReadErrorTickMakesNoKick) {
  Rig rig(loop_spec(GetParam()));
  rig.enable_at(0.048);
  const double before = rig.again().effort[0];
  for (AxisSample& sample : rig.samples) {  // the driver says position 0 and that it failed
    sample.raw = 0;
    sample.freshness = Freshness::missing;
  }
  EXPECT_NEAR(rig.run().effort[0], before, 1e-12);
  rig.samples[0].raw = Rig::raw(0.048);
  EXPECT_NEAR(rig.again().effort[0], before, 1e-9);
}

TEST_P(Failures, TheForceStaysWithinTheDevicesLimitHoweverDeep) {
  Rig rig(loop_spec(GetParam()));
  rig.enable_at(0.049);
  for (double x = 0.049; x > 0.02; x -= 1e-4) EXPECT_LE(rig.at(x).effort[0], 6.0 + 1e-12);
  EXPECT_NEAR(rig.again().effort[0], 6.0, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Scene, Failures, testing::Bool());

TEST(SceneFailures, AMovingObjectPushesAHandThatRests) {
  for (const bool coupled : {false, true}) {
    build::ProgramSpec spec = scene_spec();
    spec.waypoints = {{.at_s = 0, .position = {0, 0, -0.06}}, {.at_s = 1, .position = {0, 0, 0}}};
    spec.paths = {{.first = 0, .count = 2}};
    add_object(spec, spec.boxes, ObjectKind::box,
               control::Box{{}, {0.05, 0.05, 0.05}, Free::outside}, surface(1000))
        .path = 0;
    if (coupled) spec.coupling = {spring_damper(0, {1000, 1000, 1000})};
    SceneRig rig(std::move(spec));
    const Vec3 hand{0, 0, 0.048};
    rig.start(hand);
    for (int tick = 0; tick < 1100; ++tick) rig.at(hand);
    const double stiffness = coupled ? 500 : 1000;
    expect_point(rig.force(), {0, 0, stiffness * 0.002}, 1e-9);
    // What it gave is what the springs hold, and what each tick's push was before they gave way.
    EXPECT_NEAR(rig.program.state().injected[0], 0.5 * stiffness * 0.002 * 0.002, 5e-5);
  }
}

TEST(SceneFailures, ASphereGivesADefinedForceAtItsCentre) {
  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.spheres, ObjectKind::sphere, control::Sphere{{}, 0.05, Free::outside},
             surface(1000));
  SceneRig rig(std::move(spec));
  rig.start({0.06, 0, 0});
  for (double x = 0.05; x > 1e-9; x *= 0.5) rig.at({x, 0, 0});
  expect_point(rig.at({0, 0, 0}), {50, 0, 0}, 1e-9);  // the way it came
}

TEST(SceneFailures, ABoxKeepsTheFaceThroughWhichItWasEntered) {
  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.boxes, ObjectKind::box, control::Box{{}, {0.05, 0.05, 0.01}, Free::outside},
             surface(1000));
  SceneRig rig(std::move(spec));
  rig.start({0, 0, 0.011});
  for (double z = 0.01; z > -0.0095; z -= 0.0005) {
    expect_point(rig.at({0.049, 0, z}), {0, 0, 1000 * (0.01 - z)}, 1e-10);
  }
}

/// A scene of several bodies in the unit of length `unit` (1: the metre).
build::ProgramSpec scaled_scene(double unit, const Frame& frame) {
  build::ProgramSpec spec = scene_spec();
  const auto place = [&](const Vec3& p) { return unit * to_world(frame, p); };
  // Stiffness N per unit of length, so that forces stay.
  add_object(spec, spec.spheres, ObjectKind::sphere,
             control::Sphere{place({0, 0, 0}), 0.04 * unit, Free::outside},
             surface(2000 / unit, 0, 0.5, 0.3));
  add_object(
      spec, spec.boxes, ObjectKind::box,
      control::Box{{frame.turn, place({0.05, 0, 0})}, unit * Vec3{0.02, 0.05, 0.01}, Free::outside},
      surface(800 / unit));
  add_object(spec, spec.cylinders, ObjectKind::cylinder,
             control::Cylinder{place({-0.05, 0.01, 0}), frame.turn * Vec3{0, 1, 0}, 0.02 * unit,
                               0.05 * unit, Free::outside},
             surface(1200 / unit));
  spec.coupling = {spring_damper(0, (1000 / unit) * Vec3{1, 1, 1})};
  spec.solver_tolerance = 1e-13;
  return spec;
}

Vec3 way(int tick) {
  const double s = 1e-3 * tick;
  return {0.07 * std::cos(2 * s), 0.02 * std::sin(3 * s), 0.03 * std::cos(5 * s)};
}

TEST(SceneInvariance, UnitsPlaceAndOrientationDoNotMatter) {
  const Frame turned{{{{{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}}}}, {0.3, -0.2, 0.1}};
  SceneRig metres(scaled_scene(1, {}));
  SceneRig placed(scaled_scene(1, turned));
  SceneRig millimetres(scaled_scene(1000, {}));
  SceneRig kilometres(scaled_scene(1e-3, {}));
  double largest = 0;
  for (int tick = 0; tick < 4000; ++tick) {
    const Vec3 x = way(tick);
    const bool first = tick == 0;
    const auto run = [&](SceneRig& rig, const Vec3& at) {
      return first ? rig.start(at) : rig.at(at);
    };
    const Vec3 f = run(metres, x);
    largest = std::max(largest, norm(f));
    expect_point(run(millimetres, 1000 * x), f, 1e-7);
    expect_point(run(kilometres, 1e-3 * x), f, 1e-7);
    expect_point(run(placed, to_world(turned, x)), turned.turn * f, 1e-7);
  }
  EXPECT_GT(largest, 1);
}

TEST(SceneInvariance, TheOrderOfObjectsDoesNotMatterAndRunsRepeatToTheBit) {
  build::ProgramSpec reversed = scaled_scene(1, {});
  std::reverse(reversed.encounters.begin(), reversed.encounters.end());
  SceneRig one(scaled_scene(1, {})), same(scaled_scene(1, {})), other(std::move(reversed));
  for (int tick = 0; tick < 4000; ++tick) {
    const Vec3 x = way(tick);
    const Vec3 f = tick == 0 ? one.start(x) : one.at(x);
    EXPECT_EQ(tick == 0 ? same.start(x) : same.at(x), f);
    expect_point(tick == 0 ? other.start(x) : other.at(x), f, 1e-6);
  }
}

TEST(SceneBroadPhase, FindsAmongTenThousandObjectsWhatABruteForceSearchFinds) {
  build::ProgramSpec spec = scene_spec();
  std::vector<control::Sphere> spheres;
  for (int i = 0; i < 10000; ++i) {
    const auto at = [&](double stride) { return 0.37 * std::fmod(i * stride, 1.0); };
    add_object(spec, spec.spheres, ObjectKind::sphere,
               control::Sphere{
                   {at(0.8191725134), at(0.6710436067), at(0.5497004779)}, 0.004, Free::outside},
               surface(1000));
  }
  spheres = spec.spheres;
  SceneRig rig(std::move(spec));
  int touched = 0;
  for (int tick = 0; tick < 3000; ++tick) {
    const double s = 1e-3 * tick;
    const Vec3 x{0.18 + 0.17 * std::sin(1.1 * s), 0.18 + 0.17 * std::sin(1.7 * s), 0.12 * s};
    Vec3 wanted;
    for (const control::Sphere& sphere : spheres) {
      const Vec3 out = x - sphere.centre;
      if (const double depth = sphere.radius - norm(out); depth > 0)
        wanted += (1000 * depth / norm(out)) * out;
    }
    expect_point(tick == 0 ? rig.start(x) : rig.at(x), wanted, 1e-10);
    touched += wanted != Vec3{};
  }
  EXPECT_GT(touched, 50);
  EXPECT_LT(rig.program.state().contacts[0].near_count, 200u);
}

}  // namespace
}  // namespace hapticd::test
