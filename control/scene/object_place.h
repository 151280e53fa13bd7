// Where an object that moves is, in this tick and the last one.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Between the world and the object's frame; both are the same for an object that stands.
class ObjectPlace {
 public:
  ObjectPlace(const Plan& plan, const State& state, const Encounter& encounter) noexcept
      : moves_(encounter.path != kNoPath) {
    if (!moves_) return;
    const Path& path = plan.paths[encounter.path];
    now_ = pose_at(path, plan.waypoints, state.scene_time_s);
    before_ = pose_at(path, plan.waypoints, state.scene_last_s);
  }
  Vec3 local(const Vec3& world) const noexcept { return moves_ ? to_local(now_, world) : world; }
  Vec3 world(const Vec3& local) const noexcept { return moves_ ? to_world(now_, local) : local; }
  Vec3 turned_to_world(const Vec3& v) const noexcept { return moves_ ? now_.turn * v : v; }
  Vec3 turned_to_local(const Vec3& v) const noexcept {
    return moves_ ? transposed_times(now_.turn, v) : v;
  }
  Vec3 world_before(const Vec3& local) const noexcept {
    return moves_ ? to_world(before_, local) : local;
  }
  /// Where the object's motion has carried a point of the last tick.
  Vec3 carried(const Vec3& world) const noexcept {
    return moves_ ? to_world(now_, to_local(before_, world)) : world;
  }

 private:
  bool moves_;
  Frame now_, before_;
};

}  // namespace hapticd::control
