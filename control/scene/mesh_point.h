// The point of one triangle that is nearest to a given one, and what it is a point of: the face, an
// edge or a corner (Ericson, Real-Time Collision Detection, 2005, 5.1.5: regions by dot products
// alone).
#pragma once
#include "control/scene/mesh.h"

namespace hapticd::control {

/// Edge i runs from corner i to corner i + 1.
enum class Feature : std::uint8_t { face, edge0, edge1, edge2, corner0, corner1, corner2 };

struct TrianglePoint {
  Vec3 point{};
  double squared = 0;  ///< m^2: distance
  std::uint32_t triangle = kNoTriangle;
  Feature feature = Feature::face;
};

constexpr bool is_edge(Feature f) noexcept {
  return f >= Feature::edge0 && f <= Feature::edge2;
}
/// Number of the edge or corner.
constexpr std::size_t place(Feature f) noexcept {
  const auto number = static_cast<std::size_t>(f);
  return number > 3 ? number - 4 : number - 1;
}
constexpr std::size_t after(std::size_t corner) noexcept {
  return corner == 2 ? 0 : corner + 1;
}
constexpr std::size_t before(std::size_t corner) noexcept {
  return corner == 0 ? 2 : corner - 1;
}

inline TrianglePoint nearest_on(const Mesh& mesh, std::uint32_t triangle, const Vec3& p) noexcept {
  const MeshTriangle& t = mesh.triangles[triangle];
  const auto& [a, b, c] = t.corner;
  const Vec3 ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
  const double ab_a = dot(ab, ap), ac_a = dot(ac, ap);
  const double ab_b = dot(ab, bp), ac_b = dot(ac, bp);
  const double ab_c = dot(ab, cp), ac_c = dot(ac, cp);
  // Weights of the corners, not yet divided by their sum.
  const double of_a = ab_b * ac_c - ab_c * ac_b;
  const double of_b = ab_c * ac_a - ab_a * ac_c;
  const double of_c = ab_a * ac_b - ab_b * ac_a;
  const auto at = [&](const Vec3& point, Feature feature) {
    return TrianglePoint{point, squared_norm(p - point), triangle, feature};
  };
  if (of_a > 0 && of_b > 0 && of_c > 0) {
    const double height = dot(t.normal, ap);
    return {p - height * t.normal, height * height, triangle, Feature::face};
  }
  if (ab_a <= 0 && ac_a <= 0) return at(a, Feature::corner0);
  if (ab_b >= 0 && ac_b <= ab_b) return at(b, Feature::corner1);
  if (ac_c >= 0 && ab_c <= ac_c) return at(c, Feature::corner2);
  if (of_c <= 0 && ab_a >= 0 && ab_b <= 0)
    return at(a + (ab_a / (ab_a - ab_b)) * ab, Feature::edge0);
  if (of_b <= 0 && ac_a >= 0 && ac_c <= 0)
    return at(a + (ac_a / (ac_a - ac_c)) * ac, Feature::edge2);
  const double from_b = ac_b - ab_b, from_c = ab_c - ac_c;
  return at(b + (from_b / (from_b + from_c)) * (c - b), Feature::edge1);
}

/// Tells the side by the pseudo-normal of the feature.
SurfacePoint seen_from(const Mesh& mesh, const TrianglePoint& at, const Vec3& p) noexcept;

/// The nearest of the whole mesh, or `best` where nothing is nearer.
TrianglePoint nearest_of_all(const Mesh& mesh, const Vec3& p, TrianglePoint best) noexcept;

}  // namespace hapticd::control
