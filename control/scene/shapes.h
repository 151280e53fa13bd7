// Bodies as sets of free points. All that a shape has to answer is: which free point is nearest to
// a given one? Distance, force, friction and energy follow from that (control/scene/solve.h):
//
//   U(y) = |z - y|^2 / (2 c),   z the free point nearest to y,   c the compliance of the surface
//
// A tool of radius r is a point that must keep r from the body; every shape is that much thicker.
// Coordinates are the world's, or, for an object that moves, those of its own frame.
//
// nearest(shape, point, from, radius):
//   `from` is a free point that was reached before (the proxy of the last tick). Where several free
//   points are nearest, or nearly so, the answer is the one that `from` leads to: a box keeps the
//   face through which it was entered, the centre of a sphere gives the direction of `from`.
//   Exact: no iteration, but for Relief (relief.cpp states its accuracy) and CurveGuide's walk. No
//   absolute thresholds: the answer scales with the shape. Finite for finite arguments. Where the
//   tool is too large for a cavity nothing is free: the answer is the middle that is left, the
//   centre or a part of the axis (box: of a plane in the middle).
#pragma once
#include <cstdint>
#include <span>

#include "control/core/vec3.h"

namespace hapticd::control {

struct Nearest {
  Vec3 point{};      ///< the free point [m]
  Vec3 normal{};     ///< unit, towards the free side; point = asked + depth * normal
  double depth = 0;  ///< m; > 0: the point that was asked for is not free. <= 0: it is, and `point`
                     ///< and `normal` mean nothing
};

/// Which side of a closed shape is free.
enum class Free : std::uint8_t { outside, inside };

/// Half-space: free where normal.x >= offset.
struct Plane {
  Vec3 normal{};      ///< unit
  double offset = 0;  ///< m
};

/// A plane whose height changes along one direction: free where
///   normal.x >= offset + amplitude * g(2 pi along.x / wavelength)
/// g(s) = sin s (sinusoid), or cos s where that is negative, else 0 (groove: grooves in a flat).
/// The nearest free point of all; `from` decides under the middle of a crest. A ball that is too
/// large for a trough rests on both its flanks.
struct Relief {
  enum class Profile : std::uint8_t { sinusoid, groove };
  Vec3 normal{};          ///< unit
  Vec3 along{};           ///< unit, at right angles to `normal`
  double offset = 0;      ///< m
  double amplitude = 0;   ///< m, >= 0
  double wavelength = 0;  ///< m, > 0
  Profile profile = Profile::sinusoid;
};

struct Box {
  Frame frame{};  ///< of its centre
  Vec3 half{};    ///< m, > 0: half the length of each side
  Free free = Free::outside;
};

struct Sphere {
  Vec3 centre{};
  double radius = 0;  ///< m, > 0
  Free free = Free::outside;
};

/// With flat ends.
struct Cylinder {
  Vec3 centre{};
  Vec3 axis{};        ///< unit
  double radius = 0;  ///< m, > 0
  double half = 0;    ///< m, > 0: half its length
  Free free = Free::outside;
};

/// All points within `radius` of a segment.
struct Capsule {
  Vec3 centre{};
  Vec3 axis{};        ///< unit
  double radius = 0;  ///< m, > 0
  double half = 0;    ///< m, >= 0: half the length of the segment
  Free free = Free::outside;
};

// Guides: only their own points are free, so they pull from both sides; within `range` of them
// only, and without regard to the tool's radius.

struct PointGuide {
  Vec3 at{};
  double range = 0;  ///< m, > 0, infinity allowed: farther away there is no pull
};

/// A segment; a line where `half` is infinite.
struct LineGuide {
  Vec3 centre{};
  Vec3 axis{};      ///< unit
  double half = 0;  ///< m, > 0
  double range = 0;
};

/// A polyline through `count` vertices of plan.curve_points, each at another place than the one
/// before; closed where the first is the last. A smooth curve is given by many vertices.
struct CurveGuide {
  std::uint32_t first = 0;
  std::uint32_t count = 0;  ///< >= 2
  double range = 0;
};

Nearest nearest(const Plane& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const Relief& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const Box& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const Sphere& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const Cylinder& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const Capsule& shape, const Vec3& point, const Vec3& from, double radius) noexcept;
Nearest nearest(const PointGuide& shape, const Vec3& point) noexcept;
Nearest nearest(const LineGuide& shape, const Vec3& point) noexcept;
/// `points` are all of plan.curve_points. `segment` is the one that was nearest in the last tick (1:
/// from the first vertex on; 0: none), updated: the walk goes along the curve from there while that
/// leads nearer, at a cost that does not depend on the length of the curve. Where `segment` is not
/// one of it, as at the start and while the point is out of range, all of it is looked at.
Nearest nearest(const CurveGuide& shape, std::span<const Vec3> points, const Vec3& point,
                std::uint32_t& segment) noexcept;

}  // namespace hapticd::control
