// What holds for every body that the scene can have, for a point and for a ball. The oracle is the
// signed distance of each body.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/any_shape.h"

namespace hapticd::test::body {
namespace {

constexpr double kRounding = 1e-14;  ///< of sizes up to 5

/// From outside: the answer is free and on the surface, and nothing that is free is nearer than the
/// way out from where one starts inside.
template <class Shape>
void nearest_and_free(const Shape& shape, Random& r) {
  const double radius = any_radius(r);
  for (int n = 0; n < 20; ++n) {
    const Vec3 point = r.vector(2), from = r.vector(2);
    const double least = radius - signed_distance(shape, point);
    const Nearest held = nearest(shape, point, from, radius);
    const Nearest start = nearest(shape, point, point, radius);
    if (least < -kRounding) {
      RC_ASSERT(held.depth <= 0);
      continue;
    }
    RC_ASSERT(std::abs(start.depth - least) < kRounding);
    RC_ASSERT(held.depth > least - kRounding);
    RC_ASSERT(std::abs(norm(held.normal) - 1) < kRounding);
    RC_ASSERT(norm(held.point - point - held.depth * held.normal) < kRounding);
    RC_ASSERT(std::abs(signed_distance(shape, held.point) - radius) < kRounding);
    RC_ASSERT(signed_distance(shape, held.point + 1e-6 * held.normal) > radius);
  }
}

RC_GTEST_PROP(ShapesProperty, TheAnswerIsFreeOnTheSurfaceAndTheNearestWhereOneStarts, ()) {
  Random r;
  nearest_and_free(any_plane(r), r);
  nearest_and_free(any_sphere(r), r);
  nearest_and_free(any_box(r), r);
  nearest_and_free(any_cylinder(r), r);
  nearest_and_free(any_capsule(r), r);
}

/// What the descent check needs: to go on is never worse than to stay.
template <class Shape>
void never_farther_than_from(const Shape& shape, Random& r) {
  const double radius = any_radius(r);
  for (int n = 0; n < 20; ++n) {
    const Vec3 point = r.vector(2);
    Vec3 from = r.vector(2);
    if (n % 2 == 0) {  // as in the loop: the last answer
      const Nearest last = nearest(shape, point + r.vector(0.1), from, radius);
      if (last.depth > 0) from = last.point;
    }
    if (signed_distance(shape, from) < radius - kRounding) continue;
    RC_ASSERT(nearest(shape, point, from, radius).depth <= norm(point - from) + kRounding);
  }
}

RC_GTEST_PROP(ShapesProperty, TheAnswerIsNeverFartherThanTheFreePointItComesFrom, ()) {
  Random r;
  never_farther_than_from(any_plane(r), r);
  never_farther_than_from(any_sphere(r), r);
  never_farther_than_from(any_box(r), r);
  never_farther_than_from(any_cylinder(r), r);
  never_farther_than_from(any_capsule(r), r);
}

/// A cavity leaves a convex set free. Its nearest point z is the one with (p - z).(w - z) <= 0 for
/// all w of it; and two of them are no farther apart than the points they belong to.
template <class Shape>
void projects_on_a_convex_set(Shape shape, Random& r) {
  shape.free = Free::inside;
  const double radius = over(r.number(-0.25, 0.29));  // always some room
  const auto project = [&](const Vec3& p) {
    const Nearest found = nearest(shape, p, p, radius);
    return found.depth > 0 ? found.point : p;
  };
  const Vec3 point = r.vector(3), z = project(point);
  RC_ASSERT(signed_distance(shape, z) <= -radius + kRounding);
  for (int n = 0; n < 50; ++n) {
    const Vec3 other = r.vector(3), w = project(other);
    RC_ASSERT(dot(point - z, w - z) < 10 * kRounding);
    RC_ASSERT(norm(w - z) <= norm(other - point) + kRounding);
  }
}

RC_GTEST_PROP(ShapesProperty, CavitiesProjectOnAConvexSet, ()) {
  Random r;
  projects_on_a_convex_set(any_sphere(r), r);
  projects_on_a_convex_set(any_box(r), r);
  projects_on_a_convex_set(any_cylinder(r), r);
  projects_on_a_convex_set(any_capsule(r), r);
}

/// The distance to a set does not change faster than the point moves; a relief's answer is the
/// nearest of all, so this is its continuity.
RC_GTEST_PROP(ShapesProperty, TheDepthInAReliefIsContinuous, ()) {
  Random r;
  const Relief relief = any_relief(r);
  const double radius = any_radius(r), size = relief.wavelength;
  Vec3 point = (relief.offset - r.number(0, 0.4) * size) * relief.normal + size * r.vector(1);
  Vec3 from = point + 2 * size * relief.normal;
  double depth = nearest(relief, point, from, radius).depth;
  for (int n = 0; n < 200; ++n) {
    const Vec3 step = 0.02 * size * r.unit();
    point += step;
    const Nearest found = nearest(relief, point, from, radius);
    RC_ASSERT(std::abs(over(found.depth) - over(depth)) <= norm(step) * (1 + 1e-9));
    depth = found.depth;
    from = depth > 0 ? found.point : point;
    RC_ASSERT(nearest(relief, from, from, radius).depth < 1e-12);
  }
}

double any_far_number(Random& r) {
  const double kind = r.number(0, 4);
  if (kind < 1) return 0;
  const double size = std::pow(10, kind < 2 ? r.number(-300, 0) : r.number(-9, 6));
  return r.number(-1, 1) < 0 ? -size : size;
}

Vec3 any_far_place(Random& r) {
  return {any_far_number(r), any_far_number(r), any_far_number(r)};
}

bool finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

template <class Shape>
void finite_anywhere(Shape shape, Random& r) {
  for (int n = 0; n < 40; ++n) {
    const Vec3 point = any_far_place(r), from = n % 4 == 0 ? point : any_far_place(r);
    const double radius = over(any_far_number(r));
    if constexpr (requires { shape.free; }) shape.free = n % 2 == 0 ? Free::outside : Free::inside;
    const Nearest found = nearest(shape, point, from, radius);
    RC_ASSERT(std::isfinite(found.depth));
    RC_ASSERT(finite(found.point));
    RC_ASSERT(finite(found.normal));
    if (found.depth > 0) RC_ASSERT(std::abs(norm(found.normal) - 1) < 1e-14);
  }
}

/// At the origin, on axes, in middles, at a distance that rounds to nothing, and 1000 km away.
RC_GTEST_PROP(ShapesProperty, AnAnswerIsFiniteAndItsNormalUnitAnywhere, ()) {
  Random r;
  Sphere sphere = any_sphere(r);
  Box box = any_box(r);
  Cylinder cylinder = any_cylinder(r);
  Capsule capsule = any_capsule(r);
  Relief relief = any_relief(r);
  if (r.number(0, 1) < 0.5) {
    sphere.centre = box.frame.at = cylinder.centre = capsule.centre = {};
    box.frame.turn = diagonal(1);
    cylinder.axis = capsule.axis = relief.along = {0, 1, 0};
    relief.normal = {0, 0, 1};
    relief.offset = 0;
  }
  finite_anywhere(any_plane(r), r);
  finite_anywhere(sphere, r);
  finite_anywhere(box, r);
  finite_anywhere(cylinder, r);
  finite_anywhere(capsule, r);
  finite_anywhere(relief, r);
}

}  // namespace
}  // namespace hapticd::test::body
