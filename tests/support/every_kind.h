// A config whose scene has one object of every kind, far from each other, for one device of
// three axes; with or without a coupling.
#pragma once
#include <string>

namespace hapticd::test {

/// Surfaces have 800 N/m. "flat" is a plane that is solved like other bodies, because it names a
/// friction, of nothing.
inline std::string every_kind_text(bool coupled, const std::string& mesh_file) {
  std::string text = R"(version: 1
loop: {rate_Hz: 1000}
devices:
  - name: left
    driver: sim
    kinematics: {cartesian: {directions: [x, y, z]}}
    latency_s: 0
    axes:
)";
  for (const char* name : {"x", "y", "z"}) {
    text += std::string("      - {name: ") + name +
            ", encoder: {counts_per_m: 1.0e+6}, actuator: {max_force_N: 8}, model: {mass_kg: 0.08, "
            "damping_Ns_m: 1.5}}\n";
  }
  if (coupled) text += "coupling: {blocks: [{contacts: [left], stiffness_N_m: 800}]}\n";
  text += R"(scene:
  - plane: {name: floor, normal: [0, 0, 2], offset_m: -1, stiffness_N_m: 800}
  - plane: {name: flat, normal: [0, 1, 0], offset_m: -3, stiffness_N_m: 800,
            friction: {static: 0, dynamic: 0}}
  - texture: {name: ribs, normal: [0, 0, 1], offset_m: -2, along: [1, 0, 0], amplitude_m: 0.001,
              wavelength_m: 0.01, stiffness_N_m: 800}
  - box: {name: block, center_m: [1, 0, 0], size_m: [0.1, 0.2, 0.3], stiffness_N_m: 800}
  - box: {name: lid, center_m: [0, 0, 0], size_m: [0.1, 0.2, 0.3], stiffness_N_m: 800,
          motion: {waypoints: [{at_s: 0, position_m: [2, 0, 0]}, {at_s: 1, position_m: [2, 0, 1]}]}}
  - sphere: {name: marble, center_m: [3, 0, 0], radius_m: 0.05, stiffness_N_m: 800}
  - sphere: {name: grit, center_m: [3, 1, 0], radius_m: 0.05, stiffness_N_m: 800,
             friction: {static: 0.5, dynamic: 0.4}}
  - sphere: {name: cave, center_m: [0, 0, 0], radius_m: 50, free: inside, stiffness_N_m: 800}
  - cylinder: {name: can, center_m: [4, 0, 0], axis: [0, 0, 1], radius_m: 0.05, length_m: 0.1,
               stiffness_N_m: 800}
  - capsule: {name: pill, center_m: [5, 0, 0], axis: [0, 0, 1], radius_m: 0.05, length_m: 0.1,
              stiffness_N_m: 800}
  - mesh: {name: ball, file: )" +
          mesh_file + R"(, scale: 0.001, position_m: [6, 0, 0], stiffness_N_m: 800}
  - point: {name: home, center_m: [7, 0, 0], range_m: 0.1, stiffness_N_m: 800}
  - line: {name: rail, center_m: [8, 0, 0], axis: [0, 0, 1], length_m: 0.2, range_m: 0.1,
           stiffness_N_m: 800}
  - curve: {name: bend, points_m: [[9, 0, 0], [9, 0.1, 0], [9, 0.1, 0.1]], range_m: 0.1,
            stiffness_N_m: 800}
  - viscous: {name: syrup, center_m: [10, 0, 0], radius_m: 0.1, damping_Ns_m: 0.1}
  - constant: {name: wind, center_m: [11, 0, 0], radius_m: 0.1, force_N: [0, 0, 0.1]}
  - detents: {name: stops, along: [1, 0, 0], spacing_m: 0.01, max_force_N: 0.1}
  - magnet: {name: pole, center_m: [12, 0, 0], range_m: 0.1, max_force_N: 0.5}
  - vibration: {name: buzz, center_m: [13, 0, 0], radius_m: 0.1, force_N: [0, 0, 0.1],
                frequency_Hz: 50}
stability: {require: none}
)";
  return text;
}

}  // namespace hapticd::test
