// Sphere, cylinder and capsule. A ball of radius r around the tool is a point against a body that is
// r thicker; from inside it has r less room, and where there is none, the centre or the axis is
// what is left.
#include "control/scene/shape_parts.h"

namespace hapticd::control {
namespace {

/// What the cylinder leaves free inside is a smaller cylinder: convex, so the answer is unique.
Nearest nearest_in_cylinder(const Cylinder& body, const Vec3& point, double radius) noexcept {
  const AboutAxis at = about_axis(body.centre, body.axis, point);
  const double wide = std::max(0.0, body.radius - radius), far = std::max(0.0, body.half - radius);
  const double off = std::sqrt(at.square);
  const double over_side = std::max(0.0, off - wide);
  const double over_end = at.along - std::clamp(at.along, -far, far);
  if (over_side == 0 && over_end == 0) return {};
  const double share = over_side > 0 ? over_side / off : 0;
  const Direction back = direction(-share * at.off - over_end * body.axis);
  return pushed_out(point, back.unit, back.length);
}

/// As for the box: an end that was entered is the way out as long as the point is below it.
/// over_side, over_end: how far the point is beyond side and ends, 0 within.
Nearest out_of_cylinder(const Cylinder& body, const Vec3& point, const AboutAxis& at,
                        double over_side, double over_end, const Vec3& from,
                        double radius) noexcept {
  const AboutAxis start = about_axis(body.centre, body.axis, from);
  const double end = start.along < 0 ? -1 : 1;
  const std::array<double, 2> beyond{std::sqrt(start.square) - body.radius,
                                     end * start.along - body.half};
  const std::array<double, 2> depth{body.radius + radius - std::sqrt(at.square),
                                    body.half + radius - end * at.along};
  const bool through_end = entered_through(beyond, depth) == 1;
  const bool beyond_far_end = through_end && end * at.along < 0;
  const Vec3 away = away_from_axis(at.off, start.off, body.axis);
  if (over_side == 0 && (over_end == 0 || beyond_far_end)) {
    return through_end ? pushed_out(point, end * body.axis, depth[1])
                       : pushed_out(point, away, depth[0]);
  }
  const Direction around =
      direction(over_side * away + std::copysign(over_end, at.along) * body.axis);
  return pushed_out(point, around.unit, radius - around.length);
}

/// From the nearest point of the segment to the point.
Vec3 from_segment(const AboutAxis& at, double half, const Vec3& axis) noexcept {
  const double over_end = at.along - std::clamp(at.along, -half, half);
  return at.off + over_end * axis;
}

}  // namespace

Nearest nearest(const Sphere& shape, const Vec3& point, const Vec3& from, double radius) noexcept {
  const Vec3 off = point - shape.centre;
  const double square = squared_norm(off);
  if (shape.free == Free::inside) {
    const double room = std::max(0.0, shape.radius - radius);
    if (square <= room * room) return {};
    const Direction away = direction(off);
    return pushed_out(point, -away.unit, away.length - room);
  }
  const double reach = shape.radius + radius;
  if (square >= reach * reach) return {};
  Direction away = direction(off);
  if (away.length == 0) away.unit = direction(from - shape.centre).unit;
  return pushed_out(point, away.unit, reach - away.length);
}

Nearest nearest(const Cylinder& shape, const Vec3& point, const Vec3& from,
                double radius) noexcept {
  if (shape.free == Free::inside) return nearest_in_cylinder(shape, point, radius);
  const AboutAxis at = about_axis(shape.centre, shape.axis, point);
  const double reach = shape.radius + radius;
  const double beyond_end = std::abs(at.along) - shape.half;
  if (beyond_end >= radius || at.square >= reach * reach) return {};
  const double over_side = std::max(0.0, std::sqrt(at.square) - shape.radius);
  const double over_end = std::max(0.0, beyond_end);
  const double square = over_side * over_side + over_end * over_end;
  if (square > 0 && square >= radius * radius) return {};  // beside a rounded rim
  return out_of_cylinder(shape, point, at, over_side, over_end, from, radius);
}

Nearest nearest(const Capsule& shape, const Vec3& point, const Vec3& from, double radius) noexcept {
  const AboutAxis at = about_axis(shape.centre, shape.axis, point);
  const Vec3 off = from_segment(at, shape.half, shape.axis);
  const double square = squared_norm(off);
  if (shape.free == Free::inside) {
    const double room = std::max(0.0, shape.radius - radius);
    if (square <= room * room) return {};
    const Direction away = direction(off);
    return pushed_out(point, -away.unit, away.length - room);
  }
  const double reach = shape.radius + radius;
  if (square >= reach * reach) return {};
  Direction away = direction(off);
  if (away.length == 0) {
    const AboutAxis start = about_axis(shape.centre, shape.axis, from);
    away.unit = away_from_axis({}, start.off, shape.axis);
  }
  return pushed_out(point, away.unit, reach - away.length);
}

}  // namespace hapticd::control
