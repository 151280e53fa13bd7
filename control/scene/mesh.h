// Triangle meshes: closed, two-manifold, outward normals. Free is the outside. The contact walks
// over the surface from the triangle where it was; a tree finds the first touch, and where the walk
// has to start anew.
//
// nearest(mesh, walk, point, from, radius): as for shapes (shapes.h).
//   In contact (`walk.touching`) the answer is the local minimum of the distance that is reached by
//   descent from the last triangle: face interiors, edges, corners. It goes on continuously over
//   concave creases, and holds on its side of a wall thinner than the depth.
//   A ball is held by two or three faces at once in a crease: the one that is nearest to `point`
//   and what else comes nearer than `radius` to the answer. Where no free centre is found that way
//   (a gap narrower than the ball) `from` is the answer.
//   Not in contact: free as long as the contact stays inside the ball around `walk.clear_centre`
//   that was found empty. Beyond it the segment from -> point is tried against the surface (a wall
//   thinner than a step is not jumped over), and the next empty ball is looked for. `from` not free
//   and no walk (start, jump): inside or outside is told by the angle-weighted pseudo-normal of the
//   nearest feature of the whole mesh (Baerentzen and Aanaes 2005); inside, the nearest surface
//   point of all starts the walk.
// Lengths are compared with each other only: a mesh in millimetres, metres or kilometres gives the
// same answer, scaled.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "control/core/vec3.h"
#include "control/scene/box_tree.h"
#include "control/scene/shapes.h"

namespace hapticd::control {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

/// All that a step of the walk needs of a triangle, in two cache lines.
struct alignas(64) MeshTriangle {
  Vec3 normal{};                             ///< unit, outward
  std::array<Vec3, 3> corner{};              ///< m, counter-clockwise from outside
  std::array<std::uint32_t, 3> vertex{};     ///< the corners' numbers
  std::array<std::uint32_t, 3> neighbour{};  ///< across the edge corner[i] -> corner[i + 1]
};
static_assert(sizeof(MeshTriangle) == 128);

/// Made by build/mesh.h; all spans live in build::MeshData.
struct Mesh {
  std::span<const MeshTriangle> triangles;  ///< in the order of the tree's leaves
  std::span<const Vec3> vertex_normals;     ///< angle-weighted pseudo-normal, unit, per vertex
  BoxTree tree;                             ///< leaf: triangles[first .. first + count); no items
  /// One closed surface without a concave edge, hence the boundary of a convex body (Tietze and
  /// Nakajima 1928): a ball that touches it has nothing else in its way.
  bool convex = false;
};

struct MeshWalk {
  std::uint32_t triangle = kNoTriangle;  ///< where the walk stands; kNoTriangle: nowhere
  bool touching = false;
  Vec3 clear_centre{};
  double clear_radius = 0;  ///< m: a ball of free tool positions around clear_centre
};

Nearest nearest(const Mesh& mesh, MeshWalk& walk, const Vec3& point, const Vec3& from,
                double radius) noexcept;

/// A point of the surface as seen from another one.
struct SurfacePoint {
  Vec3 point{};
  Vec3 outward{};     ///< unit: towards the asking point if that is outside, else away from it
  double height = 0;  ///< m: signed distance of the asking point, > 0 outside
  std::uint32_t triangle = kNoTriangle;  ///< kNoTriangle: there is none
};

/// The point of the whole surface nearest to `point`, by the tree; none if it is not nearer than
/// `reach`.
SurfacePoint nearest_surface(const Mesh& mesh, const Vec3& point, double reach) noexcept;

/// The local minimum of the distance to `point` that is reached by descent from a triangle; none
/// if it is farther away than kMaxMoves triangles.
SurfacePoint descend(const Mesh& mesh, std::uint32_t triangle, const Vec3& point) noexcept;
inline constexpr int kMaxMoves = 256;

/// Number of the first triangle that the segment a -> b crosses from outside, or kNoTriangle.
std::uint32_t first_crossing(const Mesh& mesh, const Vec3& a, const Vec3& b) noexcept;

}  // namespace hapticd::control
