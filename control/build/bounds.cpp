#include "control/build/bounds.h"

#include <algorithm>
#include <cmath>

namespace hapticd::build {
namespace {

using control::ObjectKind;

Bounds around(const Vec3& centre, const Vec3& half) {
  return {centre - half, centre + half};
}

Bounds around(const Vec3& centre, double radius) {
  return around(centre, {radius, radius, radius});
}

/// None where the radius is infinite.
std::optional<Bounds> ball(const Vec3& centre, double radius) {
  if (!std::isfinite(radius)) return std::nullopt;
  return around(centre, radius);
}

Vec3 largest(const Vec3& a, const Vec3& b) {
  return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}
Vec3 smallest(const Vec3& a, const Vec3& b) {
  return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Bounds both(const Bounds& a, const Bounds& b) {
  return {smallest(a.min, b.min), largest(a.max, b.max)};
}

/// A segment and all within `reach` of it.
std::optional<Bounds> rod(const Vec3& centre, const Vec3& axis, double half, double reach) {
  if (!std::isfinite(half) || !std::isfinite(reach)) return std::nullopt;
  const Bounds ends = both(around(centre + half * axis, 0), around(centre - half * axis, 0));
  const Vec3 more{reach, reach, reach};
  return Bounds{ends.min - more, ends.max + more};
}

/// A cavity pushes on what is outside of it, however far.
template <class Shape>
std::optional<Bounds> closed(const Shape& shape, std::optional<Bounds> bounds) {
  return shape.free == control::Free::outside ? bounds : std::nullopt;
}

std::optional<Bounds> bounds_of(const control::Box& box) {
  Vec3 half;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3& row = box.frame.turn.row[i];
    half[i] =
        std::abs(row.x) * box.half.x + std::abs(row.y) * box.half.y + std::abs(row.z) * box.half.z;
  }
  return closed(box, around(box.frame.at, half));
}

std::optional<Bounds> curve_bounds(const ProgramSpec& spec, const control::CurveGuide& curve) {
  if (!std::isfinite(curve.range)) return std::nullopt;
  Bounds bounds = around(spec.curve_points[curve.first], curve.range);
  for (std::uint32_t i = 1; i < curve.count; ++i)
    bounds = both(bounds, around(spec.curve_points[curve.first + i], curve.range));
  return bounds;
}

std::optional<Bounds> at_rest(const ProgramSpec& spec, ObjectKind kind, std::uint32_t i) {
  switch (kind) {
    case ObjectKind::box:
      return bounds_of(spec.boxes[i]);
    case ObjectKind::sphere:
      return closed(spec.spheres[i], ball(spec.spheres[i].centre, spec.spheres[i].radius));
    case ObjectKind::cylinder: {
      const control::Cylinder& c = spec.cylinders[i];
      return closed(c, rod(c.centre, c.axis, c.half, c.radius));
    }
    case ObjectKind::capsule: {
      const control::Capsule& c = spec.capsules[i];
      return closed(c, rod(c.centre, c.axis, c.half, c.radius));
    }
    case ObjectKind::mesh:
      return spec.meshes[i]->bounds;
    case ObjectKind::point:
      return ball(spec.point_guides[i].at, spec.point_guides[i].range);
    case ObjectKind::line: {
      const control::LineGuide& line = spec.line_guides[i];
      return rod(line.centre, line.axis, line.half, line.range);
    }
    case ObjectKind::curve:
      return curve_bounds(spec, spec.curve_guides[i]);
    case ObjectKind::viscous:
      return ball(spec.viscous_fields[i].region.centre, spec.viscous_fields[i].region.radius);
    case ObjectKind::constant:
      return ball(spec.constant_fields[i].region.centre, spec.constant_fields[i].region.radius);
    case ObjectKind::magnet:
      return ball(spec.magnets[i].centre, spec.magnets[i].radius + spec.magnets[i].range);
    case ObjectKind::vibration:
      return ball(spec.vibrations[i].region.centre, spec.vibrations[i].region.radius);
    case ObjectKind::plane:
    case ObjectKind::relief:
    case ObjectKind::detents:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::optional<Bounds> bounds_of(const ProgramSpec& spec, const control::Encounter& encounter) {
  const std::optional<Bounds> rest = at_rest(spec, encounter.kind, encounter.shape);
  if (!rest || encounter.path == control::kNoPath) return rest;
  // However it turns, it stays in the ball around its frame's origin that holds the box.
  const double reach = norm(largest(rest->max, -rest->min));
  const control::Path& path = spec.paths[encounter.path];
  Bounds swept = around(spec.waypoints[path.first].position, reach);
  for (std::uint32_t i = 1; i < path.count; ++i)
    swept = both(swept, around(spec.waypoints[path.first + i].position, reach));
  return swept;
}

}  // namespace hapticd::build
