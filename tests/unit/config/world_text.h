// A sound config of a device with three axes and one with a single axis, without scene.
#pragma once
#include <string>

#include "tests/unit/config/support.h"

namespace hapticd::config::test {

/// Contacts ball (x, y, z) and rod (x), coordinates 0 to 2 and 3. 13 lines; what is added starts at
/// line 14.
inline const std::string kWorld = R"(version: 1
devices:
  - {name: ball, driver: sim, kinematics: {cartesian: {directions: [x, y, z]}}, latency_s: 0, axes: [
      {name: x, encoder: {counts_per_m: 1000}, actuator: {max_force_N: 8}, model: {mass_kg: 1, damping_Ns_m: 2}},
      {name: y, encoder: {counts_per_m: 1000}, actuator: {max_force_N: 8}, model: {mass_kg: 1, damping_Ns_m: 2}},
      {name: z, encoder: {counts_per_m: 1000}, actuator: {max_force_N: 8}, model: {mass_kg: 1, damping_Ns_m: 2}}]}
  - name: rod
    driver: sim
    kinematics: {cartesian: {directions: [x]}}
    pose: {position_m: [0, 0.5, 0.25]}
    latency_s: 0
    axes: [{name: q, encoder: {counts_per_m: 1000}, actuator: {max_force_N: 4}, model: {mass_kg: 1, damping_Ns_m: 2}}]
guard: {ramp_s: 0.5}
)";

inline std::string with_object(const std::string& object, const std::string& before = "") {
  return kWorld + before + "scene:\n  - " + object + "\n";
}
inline std::string with_block(const std::string& block) {
  return kWorld + "coupling: {blocks: [" + block + "]}\n";
}

}  // namespace hapticd::config::test
