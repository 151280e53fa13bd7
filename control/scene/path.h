// Objects that move along a prescribed path: waypoints in time, straight in between and turned
// along the shortest arc. The pose is a pure function of the time, so an object that nothing is
// near costs nothing, and its last pose is known without having kept it.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "control/core/vec3.h"

namespace hapticd::control {

inline constexpr std::uint32_t kNoPath = 0xffffffff;

struct Waypoint {
  double at_s = 0;
  Vec3 position{};                         ///< m, of the object's frame
  std::array<double, 4> turn{1, 0, 0, 0};  ///< unit quaternion w, x, y, z
};

/// `count` of plan.waypoints, times ascending from 0, each later than the one before. Before the
/// first and after the last the object stands still, or, with `repeat`, begins anew at the time of
/// the last.
struct Path {
  std::uint32_t first = 0;
  std::uint32_t count = 0;  ///< >= 1
  bool repeat = false;
};

/// Frame of the object at `time_s` (finite, >= 0).
Frame pose_at(const Path& path, std::span<const Waypoint> waypoints, double time_s) noexcept;

}  // namespace hapticd::control
