// Configs of the seam tests: each protocol, each timing that it has.
#pragma once
#include <string>

namespace hapticd::test {

struct Bus {
  const char* driver;
  const char* timing;
  const char* axis_keys = "";  ///< more keys of `can` of the axis
};
inline constexpr Bus kBuses[] = {{"odrive", "free_running"},
                                 {"odrive", "in_phase"},
                                 {"moteus", "reply_to_command"},
                                 {"moteus", "in_phase"},
                                 {"cia402", "in_phase"}};

/// One axis at rest at x = 2 mm, a wall at 0 (free side towards +x), a limp hand that pushes 1 N into it once forces are
/// on. 20 turns of the motor a metre.
inline std::string wall_on(const Bus& bus) {
  return std::string(R"(version: 1
loop: {rate_Hz: 1000}
devices:
  - name: arm
    driver: )") +
         bus.driver + R"(
    can: {interface: can0, watchdog_s: 0.02, timing: )" +
         bus.timing + R"(}
    latency_s: 0.003
    kinematics: {cartesian: {directions: [x]}}
    sim:
      axes: [{mass_kg: 0.05, damping_Ns_m: 1.37, position_m: 0.002}]
      hand: {mass_kg: 0.1, damping_Ns_m: 3, script: [{at_s: 0, force_N: -1}]}
    axes:
      - name: x
        encoder: {counts_per_m: 327680}
        can: {node: 3, counts_per_turn: 16384)" +
         bus.axis_keys + R"(}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 1.37}
scene:
  - plane: {name: wall, devices: [arm], normal: [1, 0, 0], offset_m: 0, stiffness_N_m: 300}
stability: {require: none}
guard: {max_force_N: 6, ramp_s: 0.1}
)";
}

/// Three axes of one device on two buses, each with a wall of its own.
inline std::string three_axes(const Bus& bus) {
  std::string axes, truth;
  const char* names[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    truth +=
        std::string(i > 0 ? ", " : "") + "{mass_kg: 0.05, damping_Ns_m: 1.37, position_m: 0.002}";
    axes += std::string("\n      - {name: ") + names[i] + ", encoder: {counts_per_m: 327680" +
            (i == 1 ? ", reversed: true" : "") + "}, can: {node: " + std::to_string(7 - 2 * i) +
            ", counts_per_turn: 16384" + (i == 2 ? ", interface: can1" : "") +
            "}, actuator: {max_force_N: 8}, model: {mass_kg: 0.05, damping_Ns_m: 1.37}}";
  }
  return std::string("version: 1\ndevices:\n  - name: arm\n    driver: ") + bus.driver +
         "\n    can: {interface: can0, watchdog_s: 0.02, timing: " + bus.timing +
         "}\n    latency_s: 0.004\n    kinematics: {cartesian: {directions: [x, y, z]}}\n    sim: "
         "{hand: {mass_kg: 0.1, damping_Ns_m: 3, script: [{at_s: 0, force_N: -1}]}, axes: [" +
         truth + "]}\n    axes:" + axes + R"(
scene:
  - plane: {name: a, devices: [arm], normal: [1, 0, 0], offset_m: 0, stiffness_N_m: 300}
  - plane: {name: b, devices: [arm], normal: [0, 1, 0], offset_m: 0, stiffness_N_m: 300}
  - plane: {name: c, devices: [arm], normal: [0, 0, 1], offset_m: 0, stiffness_N_m: 300}
stability: {require: none}
guard: {max_force_N: 6, ramp_s: 0.1}
)";
}

}  // namespace hapticd::test
