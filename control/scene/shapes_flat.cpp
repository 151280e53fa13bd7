// Plane and box. A ball of radius r around the tool is a point against a body that is r thicker:
// a box with rounded edges from outside, a smaller box from inside.
#include "control/scene/shape_parts.h"

namespace hapticd::control {
namespace {

/// What the box leaves free inside is a smaller box, so the nearest point of it is unique. Where the
/// tool is too large for it, what is left is the plane, line or point in the middle.
Nearest nearest_in_box(const Box& box, const Vec3& point, double radius) noexcept {
  const Vec3 p = to_local(box.frame, point);
  Vec3 back;
  for (std::size_t i = 0; i < 3; ++i) {
    const double room = std::max(0.0, box.half[i] - radius);
    back[i] = std::clamp(p[i], -room, room) - p[i];
  }
  if (back == Vec3{}) return {};
  const Direction way = direction(back);
  return pushed_out(point, box.frame.turn * way.unit, way.length);
}

/// `over`: the way from the box to the point, 0 inside. The face that was entered is the way out as
/// long as the point is below it, also where it is beyond the far side of a thin plate already;
/// where it is beside it, the way is around the edge.
Nearest out_of_box(const Box& box, const Vec3& point, const Vec3& p, const Vec3& over,
                   const Vec3& from, double radius) noexcept {
  const Vec3 f = to_local(box.frame, from);
  std::array<double, 3> side, beyond, depth;
  for (std::size_t i = 0; i < 3; ++i) {
    side[i] = f[i] < 0 ? -1 : 1;
    beyond[i] = side[i] * f[i] - box.half[i];
    depth[i] = box.half[i] + radius - side[i] * p[i];
  }
  const std::size_t face = entered_through(beyond, depth);
  Vec3 in_sight = over;
  if (side[face] * p[face] < 0) in_sight[face] = 0;
  if (in_sight == Vec3{}) {
    Vec3 normal;
    normal[face] = side[face];
    return pushed_out(point, box.frame.turn * normal, depth[face]);
  }
  const Direction around = direction(over);
  return pushed_out(point, box.frame.turn * around.unit, radius - around.length);
}

}  // namespace

Nearest nearest(const Plane& shape, const Vec3& point, const Vec3&, double radius) noexcept {
  const double depth = shape.offset + radius - dot(shape.normal, point);
  if (depth <= 0) return {};
  return pushed_out(point, shape.normal, depth);
}

Nearest nearest(const Box& shape, const Vec3& point, const Vec3& from, double radius) noexcept {
  if (shape.free == Free::inside) return nearest_in_box(shape, point, radius);
  const Vec3 p = to_local(shape.frame, point);
  Vec3 over;
  for (std::size_t i = 0; i < 3; ++i) {
    const double beyond = std::abs(p[i]) - shape.half[i];
    if (beyond >= radius) return {};
    over[i] = beyond > 0 ? std::copysign(beyond, p[i]) : 0;
  }
  const double square = squared_norm(over);
  if (square > 0 && square >= radius * radius) return {};  // beside a rounded edge or corner
  return out_of_box(shape, point, p, over, from, radius);
}

}  // namespace hapticd::control
