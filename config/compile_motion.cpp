// Prescribed paths of objects.
#include <cmath>

#include "config/describe.h"
#include "config/geometry.h"
#include "config/number.h"
#include "config/scene_compilation.h"

namespace hapticd::config {
namespace {

/// What people write with six digits is the same place.
constexpr double kSamePlace_m = 1e-6;
constexpr double kSameTurn = 1e-9;

void check_times(Compilation& compilation, const Motion& motion, const std::string& path) {
  for (std::size_t i = 0; i < motion.waypoints.size(); ++i) {
    const double at_s = motion.waypoints[i].at_s;
    if (i == 0 ? at_s == 0 : at_s > motion.waypoints[i - 1].at_s) continue;
    compilation.refuse(
        indexed(path + ".waypoints", i) + ".at_s",
        (i == 0 ? "expected 0 for the first waypoint"
                : "expected more than " + format_number(motion.waypoints[i - 1].at_s) +
                      " s, the time of the one before") +
            std::string(", found ") + format_number(at_s) + " s");
  }
}

/// An object that begins anew elsewhere would jump, and what it hits with it.
void check_repeat(Compilation& compilation, std::span<const control::Waypoint> made,
                  const std::string& path) {
  const control::Waypoint& first = made.front();
  const control::Waypoint& last = made.back();
  if (made.size() < 2) {
    compilation.refuse(path + ".repeat", "one waypoint is a place, not a path to repeat");
    return;
  }
  double cosine = 0;
  for (std::size_t i = 0; i < first.turn.size(); ++i) cosine += first.turn[i] * last.turn[i];
  const bool same_turn = std::abs(cosine) > 1 - kSameTurn;
  if (norm(last.position - first.position) < kSamePlace_m && same_turn) return;
  compilation.refuse(indexed(path + ".waypoints", made.size() - 1),
                     "expected the last waypoint of a repeated path to be where the first is; the "
                     "object would jump back");
}

}  // namespace

std::uint32_t compile_motion(SceneCompilation& scene, const std::optional<Motion>& motion,
                             const ObjectPlace& place) {
  if (!motion) return control::kNoPath;
  const std::string path = place.path + ".motion";
  std::vector<control::Waypoint>& waypoints = scene.spec().waypoints;
  const std::size_t first = waypoints.size();
  for (std::size_t i = 0; i < motion->waypoints.size(); ++i) {
    const MotionWaypoint& point = motion->waypoints[i];
    waypoints.push_back(
        {.at_s = point.at_s,
         .position = to_vec3(point.position_m),
         .turn = unit_quaternion(scene.all, point.rotation_quaternion,
                                 indexed(path + ".waypoints", i) + ".rotation_quaternion")});
  }
  check_times(scene.all, *motion, path);
  if (motion->repeat) check_repeat(scene.all, std::span(waypoints).subspan(first), path);
  return put(scene.spec().paths, {.first = static_cast<std::uint32_t>(first),
                                  .count = static_cast<std::uint32_t>(motion->waypoints.size()),
                                  .repeat = motion->repeat});
}

}  // namespace hapticd::config
