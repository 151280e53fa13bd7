#include "control/scene/plane.h"

#include <gtest/gtest.h>

#include "tests/support/program_fixture.h"

namespace hapticd::control {
namespace {

double force_on(const PlaneContact& plane, double x, double v) {
  double force = 0;
  add_force(plane, &x, &v, &force);
  return force;
}

TEST(Plane, PushesTowardsTheFreeSideByDepth) {
  EXPECT_DOUBLE_EQ(force_on(test::wall(1000, 0), -0.002, 0), 2.0);
}

TEST(Plane, IsNotFeltOnTheFreeSideOrOnTheSurface) {
  EXPECT_EQ(force_on(test::wall(1000, 5), 0.0, -1), 0.0);
  EXPECT_EQ(force_on(test::wall(1000, 5), 0.001, -1), 0.0);
}

TEST(Plane, DampsTheWayIn) {
  EXPECT_DOUBLE_EQ(force_on(test::wall(1000, 5), -0.001, -0.1), 1.5);
}

TEST(Plane, NeverPullsOnTheWayOut) {
  EXPECT_EQ(force_on(test::wall(1000, 5), -0.001, 10), 0.0);
}

TEST(Plane, ObliqueNormalSplitsTheForce) {
  const PlaneContact plane{
      .coordinates = 3, .normal = {0.6, 0, 0.8}, .offset = 0.01, .stiffness = 100};
  const double x[3] = {0, 5, 0}, v[3] = {0, 0, 0};
  double force[3] = {0, 0, 0};
  add_force(plane, x, v, force);
  EXPECT_DOUBLE_EQ(force[0], 0.6);
  EXPECT_EQ(force[1], 0.0);
  EXPECT_DOUBLE_EQ(force[2], 0.8);
}

TEST(Plane, ForcesOfSeveralPlanesAdd) {
  auto spec = test::spec_of(1);
  spec.planes = {test::wall(1000, 0), test::wall(500, 0)};
  test::Rig rig(spec);
  EXPECT_NEAR(rig.enable_at(-0.001).effort[0], 1.5, 1e-12);
}

}  // namespace
}  // namespace hapticd::control
