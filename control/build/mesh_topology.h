// Who is whose neighbour, which way is out, and which triangles share a corner.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "control/build/mesh.h"

namespace hapticd::build {

struct Topology {
  std::vector<std::array<std::uint32_t, 3>> corners;     ///< vertices, per triangle
  std::vector<std::array<std::uint32_t, 3>> neighbours;  ///< across edge corner i -> i + 1
  std::vector<std::uint32_t> part;                       ///< connected surface, per triangle
  std::uint32_t parts = 0;
};

/// Errors: an open edge, an edge of more than two triangles, a surface with one side.
/// All triangles of a part agree afterwards.
Result<Topology> connect(const TriangleSoup& soup);

/// Turns parts that are inside out, unless they are cavities of another part.
void turn_outwards(const TriangleSoup& soup, Topology& topology);

/// Gives each fan of triangles around a vertex a vertex of its own; returns how many were added.
std::size_t split_touching_corners(TriangleSoup& soup, Topology& topology);

}  // namespace hapticd::build
