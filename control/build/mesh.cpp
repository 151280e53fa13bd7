#include "control/build/mesh.h"

#include <algorithm>
#include <cmath>

#include "control/build/mesh_clean.h"
#include "control/build/mesh_topology.h"

namespace hapticd::build {
namespace {

using control::MeshTriangle;

/// A corner above the neighbour's plane by less than this share of the mesh is level with it.
constexpr double kLevel = 1e-12;
constexpr std::uint32_t kLeaf = 4;

MeshTriangle make_triangle(const TriangleSoup& soup, const Topology& topology, std::size_t t) {
  MeshTriangle triangle{.vertex = topology.corners[t], .neighbour = topology.neighbours[t]};
  for (std::size_t i = 0; i < 3; ++i) triangle.corner[i] = soup.vertices[triangle.vertex[i]];
  const auto& [a, b, c] = triangle.corner;
  const Vec3 normal = cross(b - a, c - a);
  triangle.normal = (1 / norm(normal)) * normal;
  return triangle;
}

BoxTreeData tree_over(const std::vector<MeshTriangle>& triangles) {
  std::vector<Bounds> bounds(triangles.size(), kNoBounds);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (const Vec3& corner : triangles[t].corner) extend(bounds[t], corner);
  return make_box_tree(bounds, kLeaf);
}

/// Puts triangles into the order of the tree's leaves: what is near in space is near in memory.
void sort_by_tree(std::vector<MeshTriangle>& triangles, BoxTreeData& tree) {
  std::vector<std::uint32_t> place(triangles.size());
  std::vector<MeshTriangle> sorted(triangles.size());
  for (std::uint32_t i = 0; i < place.size(); ++i) {
    place[tree.items[i]] = i;
    sorted[i] = triangles[tree.items[i]];
  }
  for (MeshTriangle& triangle : sorted)
    for (std::uint32_t& neighbour : triangle.neighbour) neighbour = place[neighbour];
  triangles = std::move(sorted);
  tree.items = {};
}

/// Normals of the faces around each vertex, weighted by the angle that each has there.
std::vector<Vec3> vertex_normals(const std::vector<MeshTriangle>& triangles, std::size_t vertices) {
  std::vector<Vec3> normals(vertices);
  for (const MeshTriangle& t : triangles)
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 u = t.corner[(i + 1) % 3] - t.corner[i], v = t.corner[(i + 2) % 3] - t.corner[i];
      normals[t.vertex[i]] += std::atan2(norm(cross(u, v)), dot(u, v)) * t.normal;
    }
  for (Vec3& normal : normals)
    if (const double length = norm(normal); length > 0) normal = (1 / length) * normal;
  return normals;
}

/// No corner rises above the plane of a neighbour.
bool has_no_concave_edge(const MeshData& mesh) {
  const double level = kLevel * norm(mesh.bounds.max - mesh.bounds.min);
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const MeshTriangle& t) {
    for (const std::uint32_t neighbour : t.neighbour)
      for (const Vec3& corner : mesh.triangles[neighbour].corner)
        if (dot(t.normal, corner - t.corner[0]) > level) return false;
    return true;
  });
}

std::size_t turned(const TriangleSoup& soup, const Topology& topology) {
  std::size_t count = 0;
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    count += topology.corners[t] == soup.triangles[t] ? 0 : 1;
  return count;
}

}  // namespace

Result<MeshData> make_mesh(TriangleSoup given) {
  MeshData mesh;
  auto soup = clean(std::move(given), mesh.repairs);
  if (!soup) return tl::unexpected(soup.error());
  auto topology = connect(*soup);
  if (!topology) return tl::unexpected(topology.error());
  turn_outwards(*soup, *topology);
  if (const std::size_t count = turned(*soup, *topology); count > 0)
    mesh.repairs.push_back(count_text(count, "triangle") + " turned to face outwards");
  if (const std::size_t count = split_touching_corners(*soup, *topology); count > 0)
    mesh.repairs.push_back(count_text(count, "corner") + " split where surfaces touch");

  mesh.triangles.resize(topology->corners.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    mesh.triangles[t] = make_triangle(*soup, *topology, t);
  mesh.tree = tree_over(mesh.triangles);
  sort_by_tree(mesh.triangles, mesh.tree);
  mesh.vertex_normals = vertex_normals(mesh.triangles, soup->vertices.size());
  mesh.bounds = kNoBounds;
  for (const MeshTriangle& t : mesh.triangles)
    for (const Vec3& corner : t.corner) extend(mesh.bounds, corner);
  mesh.convex = topology->parts == 1 && has_no_concave_edge(mesh);
  return mesh;
}

}  // namespace hapticd::build
