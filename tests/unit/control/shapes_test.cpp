// Reference: closed forms that are written down case by case, and for the relief a brute search
// (relief_test.cpp). What holds for every shape is in tests/property/shapes_property_test.cpp.
#include "control/scene/shapes.h"

#include <gtest/gtest.h>

namespace hapticd::control {
namespace {

constexpr double kRoot = 0.70710678118654752440;  // 1 / sqrt 2

/// Of a free point nothing but the depth means something.
void expect_free(const Nearest& found) {
  EXPECT_LE(found.depth, 0);
}

/// Rounding of lengths around 0.1 m.
void expect_answer(const Nearest& found, double depth, const Vec3& normal, const Vec3& point) {
  EXPECT_NEAR(found.depth, depth, 1e-16);
  EXPECT_LT(norm(found.normal - normal), 1e-14);
  EXPECT_LT(norm(found.point - point), 1e-16);
}

TEST(PlaneShape, ABallStopsItsRadiusBefore) {
  const Plane floor{.normal = {0, 0, 1}, .offset = 0.1};
  expect_answer(nearest(floor, {1, 2, 0.102}, {}, 0.005), 0.003, {0, 0, 1}, {1, 2, 0.105});
  expect_free(nearest(floor, {1, 2, 0.105 + 1e-12}, {}, 0.005));
}

TEST(SphereShape, OutsideAndInsideMeetTheirSurfaceRadially) {
  Sphere ball{.centre = {0.01, 0, 0}, .radius = 0.05};
  expect_answer(nearest(ball, {0.01, 0.04, 0}, {}, 0.005), 0.015, {0, 1, 0}, {0.01, 0.055, 0});
  expect_free(nearest(ball, {0.01, 0.055, 0}, {}, 0.005));
  ball.free = Free::inside;
  expect_answer(nearest(ball, {0.01, 0, 0.07}, {}, 0.005), 0.025, {0, 0, -1}, {0.01, 0, 0.045});
  expect_free(nearest(ball, {0.01, 0, 0.045}, {}, 0.005));
}

TEST(SphereShape, InItsCentreTheWayBackIsTheWayOut) {
  const Sphere ball{.centre = {1, 1, 1}, .radius = 0.5};
  expect_answer(nearest(ball, {1, 1, 1}, {1, 0.5, 1}, 0), 0.5, {0, -1, 0}, {1, 0.5, 1});
  const Nearest lost = nearest(ball, {1, 1, 1}, {1, 1, 1}, 0);
  EXPECT_EQ(lost.depth, 0.5);
  EXPECT_EQ(norm(lost.normal), 1);
}

TEST(SphereShape, ATooLargeToolIsHeldInTheCentre) {
  const Sphere cavity{.centre = {0, 0, 0}, .radius = 0.05, .free = Free::inside};
  expect_answer(nearest(cavity, {0.02, 0, 0}, {}, 0.06), 0.02, {-1, 0, 0}, {0, 0, 0});
  expect_free(nearest(cavity, {0, 0, 0}, {}, 0.06));
}

const Box kBox{.half = {0.1, 0.2, 0.3}};

TEST(BoxShape, FacesAreFlatEdgesAndCornersAreRoundForABall) {
  const double r = 0.02, s = 0.01;
  expect_answer(nearest(kBox, {0.11, 0, 0}, {1, 0, 0}, r), 0.01, {1, 0, 0}, {0.12, 0, 0});
  expect_answer(nearest(kBox, {0.1 + s, 0.2 + s, 0}, {1, 1, 0}, r), r - s / kRoot,
                {kRoot, kRoot, 0}, {0.1 + r * kRoot, 0.2 + r * kRoot, 0});
  const double third = std::sqrt(1.0 / 3);
  expect_answer(nearest(kBox, {-0.1 - s, 0.2 + s, -0.3 - s}, {-1, 1, -1}, r), r - s / third,
                {-third, third, -third}, {-0.1 - r * third, 0.2 + r * third, -0.3 - r * third});
}

TEST(BoxShape, BesideARoundedEdgeIsFree) {
  expect_free(nearest(kBox, {0.1 + 0.015, 0.2 + 0.015, 0}, {1, 1, 0}, 0.02));
  expect_free(nearest(kBox, {0.1, 0, 0}, {1, 0, 0}, 0));
}

/// A plate of 10 mm, pressed from above to beyond its middle and almost through; the last answer is
/// where the next one comes from, as in the loop.
void press_through_plate(const Frame& frame, double radius) {
  const Box plate{.frame = frame, .half = {0.1, 0.1, 0.005}};
  Vec3 proxy = to_world(frame, {0.03, -0.02, 0.02});
  const double bottom = -0.005 - radius;
  for (double z = 0.01; z > bottom + 1e-6; z -= 1e-4) {
    const Vec3 point = to_world(frame, {0.03 + z, -0.02, z});
    const Nearest found = nearest(plate, point, proxy, radius);
    proxy = found.depth > 0 ? found.point : point;
    EXPECT_NEAR(found.depth, std::max(0.0, 0.005 + radius - z), 1e-14) << z;
    EXPECT_GE(to_local(frame, proxy).z, 0.005 + radius - 1e-14) << z;
  }
  expect_free(nearest(plate, to_world(frame, {0, 0, bottom - 1e-6}), proxy, radius));
}

TEST(BoxShape, KeepsTheFaceThroughWhichItWasEntered) {
  for (const double radius : {0.0, 0.001, 0.02}) {
    press_through_plate({}, radius);
    for (double angle = 0.1; angle < 6; angle += 0.37) {  // rounding puts the proxy off the face
      const double c = std::cos(angle), s = std::sin(angle);
      press_through_plate({.turn = {{{{c, -s * c, s * s}, {s, c * c, -s * c}, {0, s, c}}}},
                           .at = {0.3, -0.7, angle}},
                          radius);
    }
  }
}

TEST(BoxShape, APointBelowTwoFacesThatFromSeesLeavesByTheNearer) {
  const Vec3 from{0.15, 0.3, 0};
  expect_answer(nearest(kBox, {0.09, 0.18, 0}, from, 0), 0.01, {1, 0, 0}, {0.1, 0.18, 0});
  expect_answer(nearest(kBox, {0.07, 0.19, 0}, from, 0), 0.01, {0, 1, 0}, {0.07, 0.2, 0});
  expect_answer(nearest(kBox, {0.07, 0.18, 0.29}, from, 0), 0.02, {0, 1, 0}, {0.07, 0.2, 0.29});
}

TEST(BoxShape, ABallThatIsPushedOverTheEdgeGoesRoundIt) {
  const Vec3 on_top{0.09, 0, 0.31};
  expect_answer(nearest(kBox, {0.104, 0, 0.303}, on_top, 0.01), 0.005, {0.8, 0, 0.6},
                {0.108, 0, 0.306});
  expect_answer(nearest(kBox, {0.104, 0, 0.2}, on_top, 0.01), 0.006, {1, 0, 0}, {0.11, 0, 0.2});
}

TEST(BoxShape, WhoeverStartsInsideLeavesByTheNearestFace) {
  const Vec3 start{0.05, -0.17, 0.1};
  expect_answer(nearest(kBox, start, start, 0.01), 0.04, {0, -1, 0}, {0.05, -0.21, 0.1});
}

TEST(BoxShape, ACavityStopsABallInItsCorner) {
  Box room = kBox;
  room.free = Free::inside;
  expect_free(nearest(room, {0.08 - 1e-12, -0.18, 0.28 - 1e-12}, {}, 0.02));
  expect_answer(nearest(room, {0.5, 0, 0}, {}, 0.02), 0.42, {-1, 0, 0}, {0.08, 0, 0});
  expect_answer(nearest(room, {0.11, 0.22, 0}, {}, 0.02), 0.05, {-0.6, -0.8, 0}, {0.08, 0.18, 0});
}

TEST(BoxShape, ATooLargeToolIsHeldInTheMiddleOfItsCavity) {
  Box room = kBox;
  room.free = Free::inside;
  expect_answer(nearest(room, {0.03, 0.04, 0.05}, {}, 0.25), 0.05, {-0.6, -0.8, 0}, {0, 0, 0.05});
}

const Cylinder kCylinder{.centre = {0, 0, 0.5}, .axis = {0, 0, 1}, .radius = 0.1, .half = 0.2};

TEST(CylinderShape, SideIsRoundEndsAreFlatAndTheRimIsRoundForABall) {
  const double r = 0.01;
  expect_answer(nearest(kCylinder, {0, 0.095, 0.5}, {0, 1, 0.5}, r), 0.015, {0, 1, 0},
                {0, 0.11, 0.5});
  expect_answer(nearest(kCylinder, {0.05, 0, 0.705}, {0.05, 0, 1}, r), 0.005, {0, 0, 1},
                {0.05, 0, 0.71});
  expect_answer(nearest(kCylinder, {0, -0.103, 0.296}, {0, -1, 0}, r), 0.005, {0, -0.6, -0.8},
                {0, -0.106, 0.292});
  expect_free(nearest(kCylinder, {0, -0.108, 0.292}, {0, -1, 0}, r));
  expect_free(nearest(kCylinder, {0.1, 0, 0.5}, {1, 0, 0.5}, 0));
}

TEST(CylinderShape, KeepsTheEndThroughWhichItWasEntered) {
  Vec3 proxy{0.01, 0, 0.8};
  for (double z = 0.71; z > 0.292; z -= 1e-3) {  // almost through a ball's reach below the far end
    const Nearest found = nearest(kCylinder, {0.01, 0, z}, proxy, 0.01);
    if (found.depth > 0) proxy = found.point;
    EXPECT_NEAR(found.depth, std::max(0.0, 0.71 - z), 1e-15) << z;
  }
  expect_free(nearest(kCylinder, {0.01, 0, 0.29}, proxy, 0.01));
}

TEST(CylinderShape, KeepsItsSideDeepBelowAnEnd) {
  expect_answer(nearest(kCylinder, {0.02, 0, 0.69}, {0.1, 0, 0.6}, 0), 0.08, {1, 0, 0},
                {0.1, 0, 0.69});
}

TEST(CylinderShape, OnItsAxisTheWayBackIsTheWayOut) {
  expect_answer(nearest(kCylinder, {0, 0, 0.5}, {0, -0.1, 0.4}, 0), 0.1, {0, -1, 0},
                {0, -0.1, 0.5});
  const Nearest lost = nearest(kCylinder, {0, 0, 0.5}, {0, 0, 0.5}, 0);
  EXPECT_EQ(lost.depth, 0.1);
  EXPECT_EQ(norm(lost.normal), 1);
  EXPECT_EQ(lost.normal.z, 0);
}

/// Rounding leaves a point of a slanted axis off it by 1e-17, in any direction.
TEST(CylinderShape, OnASlantedAxisTheAnswerLiesOnItsSide) {
  const Vec3 axis{2.0 / 7, 3.0 / 7, 6.0 / 7};
  const Cylinder slanted{.centre = {0.3, 0.1, -0.2}, .axis = axis, .radius = 0.1, .half = 5};
  for (double along = -4; along < 4; along += 0.0837) {
    const Vec3 point = slanted.centre + along * axis;
    const Nearest found = nearest(slanted, point, point + Vec3{0.3, 0.02, -0.11}, 0);
    EXPECT_NEAR(found.depth, 0.1, 1e-15);
    EXPECT_NEAR(dot(found.normal, axis), 0, 1e-15);
    EXPECT_NEAR(norm(found.normal), 1, 1e-15);
  }
}

TEST(CylinderShape, ACavityStopsABallInItsRim) {
  Cylinder room = kCylinder;
  room.free = Free::inside;
  expect_free(nearest(room, {0, 0.09, 0.69}, {}, 0.01));
  expect_answer(nearest(room, {0, 0.12, 0.5}, {}, 0.01), 0.03, {0, -1, 0}, {0, 0.09, 0.5});
  expect_answer(nearest(room, {0, 0, 0.72}, {}, 0.01), 0.03, {0, 0, -1}, {0, 0, 0.69});
  expect_answer(nearest(room, {0.12, 0, 0.73}, {}, 0.01), 0.05, {-0.6, 0, -0.8}, {0.09, 0, 0.69});
}

TEST(CylinderShape, ATooLargeToolIsHeldOnTheAxisOfItsCavity) {
  Cylinder room = kCylinder;
  room.free = Free::inside;
  expect_answer(nearest(room, {0.05, 0, 0.52}, {}, 0.15), 0.05, {-1, 0, 0}, {0, 0, 0.52});
  expect_answer(nearest(room, {0.03, 0, 0.54}, {}, 0.3), 0.05, {-0.6, 0, -0.8}, {0, 0, 0.5});
}

const Capsule kCapsule{.centre = {0, 0, 0}, .axis = {1, 0, 0}, .radius = 0.1, .half = 0.3};

TEST(CapsuleShape, SideAndCapsAreAsFarFromTheSegment) {
  expect_answer(nearest(kCapsule, {0.2, 0, -0.06}, {}, 0.01), 0.05, {0, 0, -1}, {0.2, 0, -0.11});
  expect_answer(nearest(kCapsule, {0.33, 0.04, 0}, {}, 0.01), 0.06, {0.6, 0.8, 0},
                {0.366, 0.088, 0});
  expect_free(nearest(kCapsule, {0.366, 0.088 + 1e-12, 0}, {}, 0.01));
  expect_free(nearest(kCapsule, {0.41 + 1e-12, 0, 0}, {}, 0.01));
}

TEST(CapsuleShape, OnItsSegmentTheWayBackIsTheWayOut) {
  expect_answer(nearest(kCapsule, {0.2, 0, 0}, {0.1, 0, -0.1}, 0), 0.1, {0, 0, -1}, {0.2, 0, -0.1});
  const Nearest lost = nearest(kCapsule, {0.2, 0, 0}, {5, 0, 0}, 0);
  EXPECT_EQ(lost.depth, 0.1);
  EXPECT_NEAR(norm(lost.normal), 1, 1e-15);
  EXPECT_EQ(lost.normal.x, 0);
}

TEST(CapsuleShape, ACavityHoldsABallAndATooLargeOneOnItsSegment) {
  Capsule room = kCapsule;
  room.free = Free::inside;
  expect_free(nearest(room, {0.3, 0, 0.09}, {}, 0.01));
  expect_answer(nearest(room, {0.36, 0.08, 0}, {}, 0.01), 0.01, {-0.6, -0.8, 0}, {0.354, 0.072, 0});
  expect_answer(nearest(room, {0.36, 0.08, 0}, {}, 0.2), 0.1, {-0.6, -0.8, 0}, {0.3, 0, 0});
}

}  // namespace
}  // namespace hapticd::control
