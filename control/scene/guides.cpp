// Guides pull to a point, a segment, a polyline.
#include "control/scene/shape_parts.h"

namespace hapticd::control {
namespace {

/// To the guide's nearest point, which is `way` from `point`.
Nearest pulled(const Vec3& point, const Vec3& way, double range) noexcept {
  if (squared_norm(way) > range * range) return {};
  const Direction to = direction(way);
  return pushed_out(point, to.unit, to.length);
}

/// A polyline's segment i goes from vertex i to vertex i + 1.
using Vertices = std::span<const Vec3>;

/// Where on the line of segment i the nearest point to `point` lies: 0 at its start, 1 at its end.
double place_on(Vertices vertices, std::uint32_t i, const Vec3& point) noexcept {
  const Vec3 edge = vertices[i + 1] - vertices[i];
  const double square = squared_norm(edge);
  return square > 0 ? dot(edge, point - vertices[i]) / square : 0;
}

Vec3 way_to_segment(Vertices vertices, std::uint32_t i, const Vec3& point) noexcept {
  const double place = std::clamp(place_on(vertices, i, point), 0.0, 1.0);
  return vertices[i] - point + place * (vertices[i + 1] - vertices[i]);
}

/// Of the whole curve; of equally near ones the first.
std::uint32_t nearest_segment(Vertices vertices, const Vec3& point) noexcept {
  std::uint32_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = 0; i + 1 < vertices.size(); ++i) {
    const double square = squared_norm(way_to_segment(vertices, i, point));
    if (square < least) {
      least = square;
      nearest = i;
    }
  }
  return nearest;
}

/// Goes along the curve while that leads nearer to `point`: to the local minimum of the distance
/// that segment i leads to.
std::uint32_t walk_along(Vertices vertices, std::uint32_t i, const Vec3& point) noexcept {
  const auto segments = static_cast<std::uint32_t>(vertices.size() - 1);
  const bool closed = vertices.front() == vertices.back();
  double place = place_on(vertices, i, point);
  const bool onwards = place >= 1;
  for (std::uint32_t steps = 1; steps < segments && (onwards ? place >= 1 : place <= 0); ++steps) {
    const bool at_end = onwards ? i + 1 == segments : i == 0;
    if (at_end && !closed) return i;
    const std::uint32_t next = onwards ? (at_end ? 0 : i + 1) : (at_end ? segments : i) - 1;
    place = place_on(vertices, next, point);
    i = next;
  }
  return i;
}

}  // namespace

Nearest nearest(const PointGuide& shape, const Vec3& point) noexcept {
  return pulled(point, shape.at - point, shape.range);
}

Nearest nearest(const LineGuide& shape, const Vec3& point) noexcept {
  const AboutAxis at = about_axis(shape.centre, shape.axis, point);
  const double over_end = at.along - std::clamp(at.along, -shape.half, shape.half);
  return pulled(point, -at.off - over_end * shape.axis, shape.range);
}

Nearest nearest(const CurveGuide& shape, std::span<const Vec3> points, const Vec3& point,
                std::uint32_t& segment) noexcept {
  const Vertices vertices = points.subspan(shape.first, shape.count);
  const bool known = segment > 0 && segment < vertices.size();
  const std::uint32_t i =
      known ? walk_along(vertices, segment - 1, point) : nearest_segment(vertices, point);
  const Vec3 way = way_to_segment(vertices, i, point);
  segment = squared_norm(way) <= shape.range * shape.range ? i + 1 : 0;
  return pulled(point, way, shape.range);
}

}  // namespace hapticd::control
