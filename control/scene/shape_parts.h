// What shapes have in common: directions, points about an axis, and the face that a convex body was
// entered through.
#pragma once
#include <algorithm>
#include <array>
#include <limits>

#include "control/core/vec3.h"
#include "control/scene/shapes.h"

namespace hapticd::control {

/// `length` along `unit`.
struct Direction {
  Vec3 unit{};
  double length = 0;
};

/// Of a vector below 1e-140 m, whose square leaves the range of double, length 0 along z.
inline Direction direction(const Vec3& v) noexcept {
  constexpr double kLeastSquare = 1e-280;
  const double square = squared_norm(v);
  if (square < kLeastSquare) return {{0, 0, 1}, 0};
  const double length = std::sqrt(square);
  return {{v.x / length, v.y / length, v.z / length}, length};
}

/// The free point at `depth` > 0 along `normal` from the point that was asked for.
inline Nearest pushed_out(const Vec3& point, const Vec3& normal, double depth) noexcept {
  return {.point = point + depth * normal, .normal = normal, .depth = depth};
}

/// A point seen from an axis: centre + along * axis + off, `off` at right angles to the axis.
struct AboutAxis {
  double along = 0;
  Vec3 off{};
  double square = 0;  ///< |off|^2
};

/// Projected twice: what rounding of a long vector leaves along the axis is no part of `off`. Where
/// `off` is not above that rounding the point is on the axis.
inline AboutAxis about_axis(const Vec3& centre, const Vec3& axis, const Vec3& point) noexcept {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const Vec3 v = point - centre;
  const double along = dot(axis, v);
  Vec3 off = v - along * axis;
  off -= dot(axis, off) * axis;
  const double square = squared_norm(off);
  if (square <= kRounding * kRounding * squared_norm(v)) return {.along = along};
  return {.along = along, .off = off, .square = square};
}

/// A unit vector at right angles to the unit vector `axis`.
inline Vec3 any_across(const Vec3& axis) noexcept {
  const double x = std::abs(axis.x), y = std::abs(axis.y), z = std::abs(axis.z);
  const Vec3 least = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return direction(cross(axis, least)).unit;
}

/// From the axis to a point that is `off` from it; on the axis the way that `from` is off, and
/// where that is on it too, any way across.
inline Vec3 away_from_axis(const Vec3& off, const Vec3& from_off, const Vec3& axis) noexcept {
  const Direction away = direction(off);
  if (away.length > 0) return away.unit;
  const Direction held = direction(from_off);
  return held.length > 0 ? held.unit : any_across(axis);
}

/// Which face of a convex body leads out: the least deep of those that `from` is outside of.
/// `beyond[i]`: how far `from` is beyond face i [m]. Where it is beyond none, on a face by rounding
/// or inside from the start, the face that it is nearest to.
template <std::size_t N>
std::size_t entered_through(const std::array<double, N>& beyond,
                            const std::array<double, N>& depth) noexcept {
  std::size_t face = 0;
  for (std::size_t i = 1; i < N; ++i)
    if (beyond[i] > beyond[face]) face = i;
  for (std::size_t i = 0; i < N; ++i)
    if (beyond[i] >= 0 && depth[i] < depth[face]) face = i;
  return face;
}

}  // namespace hapticd::control
