// Coulomb friction against its law: a cone for what sticks, another for what slides.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/support/scene_fixture.h"

namespace hapticd::test {
namespace {

using control::ObjectKind;

constexpr double kDepth = 0.002;  // m: the hand is pushed 2 mm into the floor z = 0

struct Floor {
  double static_friction = 0;
  double dynamic_friction = 0;
  double coupling = 0;  ///< N/m; 0: rendered directly
  bool is_rigid = false;
};

SceneRig floor_rig(const Floor& floor) {
  build::ProgramSpec spec = scene_spec();
  const control::Surface feel =
      floor.is_rigid ? rigid(floor.static_friction, floor.dynamic_friction)
                     : surface(1000, 0, floor.static_friction, floor.dynamic_friction);
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{0, 0, 1}, 0}, feel);
  if (floor.coupling > 0)
    spec.coupling = {spring_damper(0, {floor.coupling, floor.coupling, floor.coupling})};
  return SceneRig(std::move(spec));
}

double ratio(const Vec3& force) {
  return std::hypot(force.x, force.y) / force.z;
}

class Friction : public testing::TestWithParam<Floor> {};

TEST_P(Friction, RatioIsMuWhileItSlidesAtAnySpeed) {
  for (const double speed : {0.005, 0.02, 0.2}) {
    SceneRig rig = floor_rig(GetParam());
    rig.start({0, 0, 0.001});
    rig.at({0, 0, -kDepth});
    double least = 1e9, most = 0;
    for (int tick = 1; tick <= 8000; ++tick) {
      const Vec3 f = rig.at({speed * tick * 1e-3, 0, -kDepth});
      if (tick < 4000) continue;
      least = std::min(least, ratio(f));
      most = std::max(most, ratio(f));
      EXPECT_LT(f.x, 0);
    }
    EXPECT_NEAR(least, GetParam().dynamic_friction, 1e-9) << speed;
    EXPECT_NEAR(most, GetParam().dynamic_friction, 1e-9) << speed;
  }
}

TEST_P(Friction, BreaksAwayAtTheStaticCone) {
  SceneRig rig = floor_rig(GetParam());
  rig.start({0, 0, 0.001});
  rig.at({0, 0, -kDepth});
  double most = 0;
  for (int tick = 1; tick <= 4000; ++tick)
    most = std::max(most, ratio(rig.at({0.02 * tick * 1e-3, 0, -kDepth})));
  // One tick moves the hand by 20 um: the last force before the break is within that of the cone.
  EXPECT_LE(most, GetParam().static_friction + 1e-12);
  EXPECT_GE(most, GetParam().static_friction - 0.0101);
}

TEST_P(Friction, HoldsWithoutCreep) {
  SceneRig rig = floor_rig(GetParam());
  rig.start({0, 0, 0.001});
  rig.at({0, 0, -kDepth});
  const double half_cone = 0.5 * GetParam().static_friction * kDepth;  // m: every spring in series
  const Vec3 held = rig.at({half_cone, 0, -kDepth});
  EXPECT_NEAR(ratio(held), 0.5 * GetParam().static_friction, 1e-9);
  for (int tick = 0; tick < 5000; ++tick) EXPECT_EQ(rig.at({half_cone, 0, -kDepth}), held);
}

INSTANTIATE_TEST_SUITE_P(Scene, Friction,
                         testing::Values(Floor{0.5, 0.5}, Floor{0.8, 0.4}, Floor{0.1, 0.1},
                                         Floor{2, 2}, Floor{0.5, 0.5, 2000}, Floor{0.8, 0.4, 600},
                                         Floor{0.8, 0.4, 900, true}));

TEST(SceneFriction, OnASphereTheForceStaysOnTheCone) {
  // The hand drags around a sphere, 1 mm deep: tangential / normal = mu up to the sag of one tick.
  build::ProgramSpec spec = scene_spec();
  const double radius = 0.05, mu = 0.4;
  add_object(spec, spec.spheres, ObjectKind::sphere,
             control::Sphere{{}, radius, control::Free::outside}, surface(1000, 0, mu, mu));
  SceneRig rig(std::move(spec));
  rig.start({0.051, 0, 0});
  for (int tick = 0; tick < 3000; ++tick) {
    const double angle = 5e-4 * tick;
    const Vec3 out{std::cos(angle), std::sin(angle), 0};
    const Vec3 f = rig.at((radius - 0.001) * out);
    if (tick < 1000) continue;
    const Vec3 z = (radius - 0.001) * out + 1e-3 * f;
    EXPECT_NEAR(norm(z), radius, 1e-7);
    const Vec3 normal = (1 / norm(z)) * z;
    const double push = dot(f, normal);
    EXPECT_NEAR(norm(f - push * normal) / push, mu, 1e-3);
  }
}

/// A mass pulled over the floor by a spring and damper whose end moves at `speed`: the spread of
/// the friction force over the last seconds.
double spread(const Floor& floor, double speed) {
  SceneRig rig = floor_rig(floor);
  const double mass = 0.1, stiffness = 300, damping = 2, step = 1e-3;
  rig.start({0, 0, 0.001});
  rig.at({0, 0, -kDepth});
  double x = 0, v = 0, least = 1e9, most = -1e9;
  for (int tick = 0; tick < 20000; ++tick) {
    const double friction = -rig.at({x, 0, -kDepth}).x;
    if (tick > 10000) {
      least = std::min(least, friction);
      most = std::max(most, friction);
    }
    for (int sub = 0; sub < 20; ++sub) {
      const double pull =
          stiffness * (speed * (tick + sub / 20.0) * step - x) + damping * (speed - v);
      v += (pull - friction) / mass * step / 20;
      x += v * step / 20;
    }
  }
  return most - least;
}

TEST(SceneFriction, SticksAndSlipsWhereTheStaticConeIsWiderAndTheHandIsSlow) {
  EXPECT_GT(spread({.static_friction = 0.8, .dynamic_friction = 0.4}, 0.005), 1.0);
  EXPECT_GT(spread({.static_friction = 0.8, .dynamic_friction = 0.4}, 0.02), 1.0);
  EXPECT_LT(spread({.static_friction = 0.8, .dynamic_friction = 0.4}, 0.1), 0.05);
  EXPECT_LT(spread({.static_friction = 0.5, .dynamic_friction = 0.5}, 0.005), 0.01);
}

TEST(SceneFriction, AMovingFloorCarriesWhatSticksToIt) {
  build::ProgramSpec spec = scene_spec();
  spec.waypoints = {{.at_s = 0, .position = {0, 0, 0}}, {.at_s = 10, .position = {0.1, 0, 0}}};
  spec.paths = {{.first = 0, .count = 2}};
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{0, 0, 1}, 0},
             surface(1000, 0, 0.5, 0.5))
      .path = 0;
  SceneRig rig(std::move(spec));
  rig.start({0, 0, 0.001});
  rig.at({0, 0, -kDepth});
  for (int tick = 2; tick < 50; ++tick) {
    const Vec3 f = rig.at({0, 0, -kDepth});
    // 10 mm/s, from the touch on: the hand came in after a third of its first tick.
    EXPECT_NEAR(f.x, 1000 * 0.01 * 1e-3 * (tick - 1 + 2 / 3.0), 1e-9);
  }
  // Of the tick of the touch all of the floor's way is booked, though the hand came by itself.
  const double pulled = std::pow(48 + 2 / 3.0, 2) - std::pow(2 / 3.0, 2);
  EXPECT_NEAR(rig.program.state().injected[0], 0.5 * 1000 * 1e-10 * (pulled + 1), 1e-9);
}

}  // namespace
}  // namespace hapticd::test
