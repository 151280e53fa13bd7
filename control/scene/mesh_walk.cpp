// The walk over a mesh: steepest way down the distance, triangle by triangle. The interior of a
// face is a minimum as it is; on an edge the neighbour may be nearer, at a corner any triangle of
// the fan. Every move lowers the distance strictly, so the walk ends.
#include "control/scene/mesh_point.h"

namespace hapticd::control {
namespace {

std::size_t corner_of(const MeshTriangle& triangle, std::uint32_t vertex) noexcept {
  return triangle.vertex[0] == vertex ? 0 : triangle.vertex[1] == vertex ? 1 : 2;
}

/// The nearest of the triangles around the corner that `at` is.
TrianglePoint around_corner(const Mesh& mesh, const TrianglePoint& at, const Vec3& p) noexcept {
  const MeshTriangle* triangle = &mesh.triangles[at.triangle];
  std::size_t corner = place(at.feature);
  const std::uint32_t vertex = triangle->vertex[corner];
  TrianglePoint best = at;
  for (std::uint32_t next = triangle->neighbour[corner]; next != at.triangle;
       next = triangle->neighbour[corner]) {
    triangle = &mesh.triangles[next];
    corner = corner_of(*triangle, vertex);
    const TrianglePoint here = nearest_on(mesh, next, p);
    if (here.squared < best.squared) best = here;
  }
  return best;
}

Vec3 pseudo_normal(const Mesh& mesh, const TrianglePoint& at) noexcept {
  const MeshTriangle& triangle = mesh.triangles[at.triangle];
  if (at.feature == Feature::face) return triangle.normal;
  if (!is_edge(at.feature)) return mesh.vertex_normals[triangle.vertex[place(at.feature)]];
  return triangle.normal + mesh.triangles[triangle.neighbour[place(at.feature)]].normal;
}

/// Nearer to an edge or corner than this share of the triangle, direction is rounding.
constexpr double kTooNear = 1e-9;

}  // namespace

SurfacePoint seen_from(const Mesh& mesh, const TrianglePoint& at, const Vec3& p) noexcept {
  const Vec3 normal = pseudo_normal(mesh, at);
  const Vec3 away = p - at.point;
  const MeshTriangle& triangle = mesh.triangles[at.triangle];
  if (at.feature == Feature::face)
    return {at.point, normal, dot(normal, p - triangle.corner[0]), at.triangle};
  const double side = dot(away, normal) >= 0 ? 1 : -1;
  const double distance = std::sqrt(at.squared);
  const double size = squared_norm(triangle.corner[1] - triangle.corner[0]);
  if (at.squared > kTooNear * kTooNear * size)
    return {at.point, (side / distance) * away, side * distance, at.triangle};
  const double length = norm(normal);
  return {at.point, length > 0 ? (1 / length) * normal : triangle.normal, side * distance,
          at.triangle};
}

SurfacePoint descend(const Mesh& mesh, std::uint32_t triangle, const Vec3& point) noexcept {
  TrianglePoint at = nearest_on(mesh, triangle, point);
  for (int move = 0; move < kMaxMoves; ++move) {
    if (at.feature == Feature::face) return seen_from(mesh, at, point);
    const TrianglePoint next =
        is_edge(at.feature)
            ? nearest_on(mesh, mesh.triangles[at.triangle].neighbour[place(at.feature)], point)
            : around_corner(mesh, at, point);
    if (!(next.squared < at.squared)) return seen_from(mesh, at, point);
    at = next;
  }
  return {};
}

}  // namespace hapticd::control
