#include "control/scene/mesh.h"

#include <limits>

#include "control/scene/cuts.h"
#include "control/scene/mesh_point.h"

namespace hapticd::control {
namespace {

/// A ball is free that comes nearer than its radius by this share of it.
constexpr double kSunkShare = 1e-9;
/// Faces that are tried one after the other for a ball in a crease.
constexpr int kMaxCuts = 16;
/// Share of the height above the walk's triangle that is tried as the next empty ball. A whole one
/// would mean to look at every triangle below; half a one stays clear of nearly all.
constexpr double kClearShare = 0.5;

/// The centre of a ball of `radius` that touches at `at`.
Nearest touching(const SurfacePoint& at, const Vec3& p, double radius) noexcept {
  const double depth = radius - at.height;
  return {p + depth * at.outward, at.outward, depth};
}

/// What keeps the centre of a ball away from where it touches.
Cut cut_at(const SurfacePoint& at, double radius) noexcept {
  return {at.outward, dot(at.outward, at.point) + radius};
}

/// The free centre nearest to `p` behind the cut that `first` makes and those of all faces that
/// come too near to the answer. False: none was found.
bool settle(const Mesh& mesh, const SurfacePoint& first, const Vec3& p, double radius,
            Vec3& centre) noexcept {
  Cuts cuts{.cut = {cut_at(first, radius)}, .count = 1};
  std::uint32_t near = first.triangle;
  for (int i = 0; i < kMaxCuts; ++i) {
    if (!project(cuts, p, centre)) return false;
    const SurfacePoint at =
        seen_from(mesh, nearest_of_all(mesh, centre, nearest_on(mesh, near, centre)), centre);
    if (at.height >= radius - kSunkShare * radius) return true;
    near = at.triangle;
    keep_active(cuts, centre);
    cuts.cut[cuts.count++] = cut_at(at, radius);
  }
  return false;
}

/// A ball that touches at `at`, where other faces may be in its way.
Nearest hold_ball(const Mesh& mesh, const SurfacePoint& at, const Vec3& p, const Vec3& from,
                  double radius) noexcept {
  Vec3 centre;
  const double back = squared_norm(from - p);
  if (!settle(mesh, at, p, radius, centre) || squared_norm(centre - p) > back) centre = from;
  const Vec3 out = centre - p;
  const double depth = norm(out);
  return depth > 0 ? Nearest{centre, (1 / depth) * out, depth} : touching(at, p, radius);
}

Nearest hold(const Mesh& mesh, MeshWalk& walk, const SurfacePoint& at, const Vec3& p,
             const Vec3& from, double radius) noexcept {
  walk.touching = true;
  walk.triangle = at.triangle;
  return radius > 0 && !mesh.convex ? hold_ball(mesh, at, p, from, radius)
                                    : touching(at, p, radius);
}

/// Whether holding there is no farther than staying at `from`. A ball on an edge may have come in
/// on a face from which the way out is longer than the one it came by.
bool comes_nearer(const SurfacePoint& at, const Vec3& p, const Vec3& from, double radius) noexcept {
  const double depth = radius - at.height;
  return depth * depth <= (1 + kSunkShare) * squared_norm(p - from);
}

/// The nearest of the whole mesh, beginning with where the walk stood. None, where the square of
/// the distance is not a number any more.
SurfacePoint search_from(const Mesh& mesh, const MeshWalk& walk, const Vec3& p) noexcept {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  const TrianglePoint last = walk.triangle == kNoTriangle ? TrianglePoint{.squared = kFar}
                                                          : nearest_on(mesh, walk.triangle, p);
  const TrianglePoint best = nearest_of_all(mesh, p, last);
  return best.triangle == kNoTriangle ? SurfacePoint{} : seen_from(mesh, best, p);
}

/// Free as before: there is an empty ball around `p`, and from `from`, which is free, the way into
/// it is free. False: one cannot tell that easily.
bool find_clear_ball(const Mesh& mesh, MeshWalk& walk, const Vec3& p, const Vec3& from,
                     double radius) noexcept {
  if (!(walk.clear_radius > 0) || walk.triangle == kNoTriangle) return false;
  const SurfacePoint below = descend(mesh, walk.triangle, p);
  if (below.triangle == kNoTriangle || !(below.height > radius)) return false;
  const double clear = kClearShare * (below.height - radius);
  const double reach = (radius + clear) * (radius + clear);
  if (nearest_of_all(mesh, p, {.squared = reach}).triangle != kNoTriangle) return false;
  if (squared_norm(p - from) >= reach && first_crossing(mesh, from, p) != kNoTriangle) return false;
  walk = {below.triangle, false, p, clear};
  return true;
}

/// First touch, release, start: by the whole mesh.
Nearest look_around(const Mesh& mesh, MeshWalk& walk, const Vec3& p, const Vec3& from,
                    double radius) noexcept {
  const SurfacePoint nearest = search_from(mesh, walk, p);
  if (nearest.triangle == kNoTriangle) return {};
  if (squared_norm(p - from) > nearest.height * nearest.height) {
    const std::uint32_t crossed = first_crossing(mesh, from, p);
    const SurfacePoint at = crossed == kNoTriangle ? SurfacePoint{} : descend(mesh, crossed, p);
    if (at.triangle != kNoTriangle && at.height < radius)
      return hold(mesh, walk, at, p, from, radius);
  }
  if (nearest.height < radius) return hold(mesh, walk, nearest, p, from, radius);
  walk = {nearest.triangle, false, p, nearest.height - radius};
  return {};
}

}  // namespace

Nearest nearest(const Mesh& mesh, MeshWalk& walk, const Vec3& point, const Vec3& from,
                double radius) noexcept {
  if (walk.touching && walk.triangle != kNoTriangle) {
    const SurfacePoint at = descend(mesh, walk.triangle, point);
    if (at.triangle != kNoTriangle && at.height < radius && comes_nearer(at, point, from, radius))
      return hold(mesh, walk, at, point, from, radius);
  } else if (squared_norm(point - walk.clear_centre) < walk.clear_radius * walk.clear_radius) {
    return {};
  } else if (find_clear_ball(mesh, walk, point, from, radius)) {
    return {};
  }
  return look_around(mesh, walk, point, from, radius);
}

}  // namespace hapticd::control
