// Triangles of a file -> a mesh that the loop can walk over: welded, checked, oriented, with
// neighbours, pseudo-normals and a tree.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "control/build/box_tree.h"
#include "control/core/result.h"
#include "control/scene/mesh.h"

namespace hapticd::build {

/// As read: any order, vertices possibly repeated.
struct TriangleSoup {
  std::vector<Vec3> vertices;                           ///< m
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices of vertices
};

/// Storage of one mesh; shared by all objects that show it in the same place. Not movable while
/// view() is in use.
struct MeshData {
  std::vector<control::MeshTriangle> triangles;
  std::vector<Vec3> vertex_normals;
  BoxTreeData tree;
  bool convex = false;
  Bounds bounds;
  std::vector<std::string> repairs;  ///< what was mended, for people; empty: nothing
  control::Mesh view() const noexcept {
    return {triangles, vertex_normals, {tree.nodes, {}}, convex};
  }
};

/// Welds equal vertices. Drops triangles without area and repeated ones, turns a mesh that is
/// inside out, splits corners in which two surfaces touch (each a line in `repairs`). Errors
/// (ExitCode::bad_data), with counts and the place of the first: no triangle left, vertex not
/// finite, index out of range, an edge of more than two triangles, an open edge, neighbours of
/// opposite orientation that cannot be turned to agree. Disconnected closed parts are fine; each is
/// oriented by itself (a part inside another is a cavity and stays as it is). Parts must not reach
/// into each other: this is not checked.
Result<MeshData> make_mesh(TriangleSoup soup);

}  // namespace hapticd::build
