// A sound config of a five-bar: two rotary axes.
#pragma once
#include <string>

namespace hapticd::config::test {

inline const std::string kFiveBar = R"(version: 1
devices:
  - name: arm
    driver: sim
    kinematics: {five_bar: {link_m: 0.2, base_m: 0.1}}
    latency_s: 0
    axes:
      - name: a
        kind: rotary
        encoder: {counts_per_rev: 32768, bits: 24}
        actuator: {max_torque_Nm: 0.4}
        model: {inertia_kgm2: 2.0e-4, damping_Nms_rad: 8.0e-4, coulomb_Nm: 2.0e-3}
      - name: b
        kind: rotary
        encoder: {counts_per_rev: 32768, bits: 24}
        actuator: {max_torque_Nm: 0.3}
        model: {inertia_kgm2: 2.0e-4, damping_Nms_rad: 8.0e-4, coulomb_Nm: 2.0e-3}
scene:
  - plane: {name: floor, normal: [0, 1, 0], offset_m: 0.2, stiffness_N_m: 100, damping_Ns_m: 1}
guard: {max_force_N: 1.5}
)";

}  // namespace hapticd::config::test
