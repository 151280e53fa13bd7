// A scene in another place, turned, in millimetres or kilometres, is the same scene.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/any_shape.h"

namespace hapticd::test::body {
namespace {

struct Similarity {
  double scale;
  Frame frame;
  Vec3 turned(const Vec3& v) const { return frame.turn * v; }
  Vec3 moved(const Vec3& p) const { return scale * to_world(frame, p); }
};

Plane moved(const Plane& s, const Similarity& m) {
  const Vec3 normal = m.turned(s.normal);
  return {.normal = normal, .offset = dot(normal, m.moved(s.offset * s.normal))};
}
Relief moved(const Relief& s, const Similarity& m) {
  const Vec3 normal = m.turned(s.normal);
  return {.normal = normal,
          .along = m.turned(s.along),
          .offset = dot(normal, m.moved(s.offset * s.normal)),
          .amplitude = m.scale * s.amplitude,
          .wavelength = m.scale * s.wavelength,
          .profile = s.profile};
}
Sphere moved(Sphere s, const Similarity& m) {
  return {.centre = m.moved(s.centre), .radius = m.scale * s.radius, .free = s.free};
}
Box moved(const Box& s, const Similarity& m) {
  return {.frame = {m.frame.turn * s.frame.turn, m.moved(s.frame.at)},
          .half = m.scale * s.half,
          .free = s.free};
}
template <class Rod>
Rod moved_rod(Rod s, const Similarity& m) {
  s.centre = m.moved(s.centre);
  s.axis = m.turned(s.axis);
  s.radius *= m.scale;
  s.half *= m.scale;
  return s;
}
Cylinder moved(const Cylinder& s, const Similarity& m) {
  return moved_rod(s, m);
}
Capsule moved(const Capsule& s, const Similarity& m) {
  return moved_rod(s, m);
}

template <class Shape>
void same_when_moved(const Shape& shape, const Similarity& m, Random& r) {
  const double radius = any_radius(r);
  for (int n = 0; n < 10; ++n) {
    const Vec3 point = r.vector(2), from = r.vector(2);
    const Nearest here = nearest(shape, point, from, radius);
    const Nearest there = nearest(moved(shape, m), m.moved(point), m.moved(from), m.scale * radius);
    RC_ASSERT(std::abs(over(there.depth) - m.scale * over(here.depth)) < 1e-12 * m.scale);
    if (here.depth < 1e-9) continue;
    RC_ASSERT(norm(there.point - m.moved(here.point)) < 1e-12 * m.scale);
  }
}

template <class Shape>
void cavity_too(Shape shape, const Similarity& m, Random& r) {
  same_when_moved(shape, m, r);
  shape.free = Free::inside;
  same_when_moved(shape, m, r);
}

RC_GTEST_PROP(ShapesProperty, MovesTurnsAndScalesWithTheWorld, ()) {
  Random r;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Similarity m{scale, {r.turn(), r.vector(1)}};
    same_when_moved(any_plane(r), m, r);
    cavity_too(any_sphere(r), m, r);
    cavity_too(any_box(r), m, r);
    cavity_too(any_cylinder(r), m, r);
    cavity_too(any_capsule(r), m, r);
  }
}

/// Phases of a relief count from the origin: it turns and scales, but moves along itself.
RC_GTEST_PROP(ShapesProperty, AReliefTurnsAndScalesWithTheWorld, ()) {
  Random r;
  for (const double scale : {1e-3, 1.0, 1e3}) {
    const Relief relief = any_relief(r);
    const Similarity m{scale, {r.turn(), {}}};
    for (int n = 0; n < 10; ++n) {
      const Vec3 point = r.vector(1);
      const double radius = any_radius(r);
      const Nearest here = nearest(relief, point, {}, radius);
      const Nearest there = nearest(moved(relief, m), m.moved(point), {}, scale * radius);
      RC_ASSERT(std::abs(over(there.depth) - scale * over(here.depth)) < 1e-11 * scale);
    }
  }
}

}  // namespace
}  // namespace hapticd::test::body
