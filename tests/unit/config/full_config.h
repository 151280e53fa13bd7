// A config that has every key of the format.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace hapticd::config::test {

using nlohmann::json;

/// What all surfaces have, each with a value that is not its default.
inline const json kSurface = json::parse(R"({
  "name": "w", "devices": ["a"], "stiffness_N_m": 3, "rigid": true, "damping_Ns_m": 0.1,
  "friction": {"static": 1, "dynamic": 0.5},
  "motion": {"waypoints": [{"at_s": 1, "position_m": [1, 2, 3], "rotation_quaternion": [0, 1, 0, 0]}],
             "repeat": true}
})");

inline json with_surface_keys(json config) {
  config["scene"][0]["plane"].update(kSurface);
  return config;
}

/// Every key that there is, each with a value that is not its default. JSON is YAML, so the reader
/// takes it.
inline const json kFull = with_surface_keys(json::parse(R"({
  "version": 1,
  "loop": {"rate_Hz": 500, "priority": 10, "cpu": 1, "max_gap_ticks": 7, "max_missed_per_s": 8},
  "start": {"enable": "when_ready"},
  "devices": [{
    "name": "a", "driver": "sim", "latency_s": 0.001,
    "sim": {
      "axes": [{"mass_kg": 1, "inertia_kgm2": 1, "damping_Ns_m": 2, "damping_Nms_rad": 2, "coulomb_N": 0.1,
                "coulomb_Nm": 0.1, "delay_s": 0.001, "position_m": 0.1, "position_rad": 0.1, "noise_counts": 1,
                "dac_step_N": 0.01, "dac_step_Nm": 0.01, "relative": true, "index_m": 0.1, "index_rad": 0.1,
                "stops_m": [-1, 1], "stops_rad": [-1, 1], "homed_at_s": 1}],
      "linkage": {"inner_link_kg": 1, "outer_link_kg": 2, "tip_kg": 3, "gravity_m_s2": [0, 0, -9]},
      "hand": {"mass_kg": 1, "stiffness_N_m": 2, "damping_Ns_m": 3, "direction": [0, 1, 0],
               "script": [{"at_s": 1, "force_N": 2, "position_m": 0.3}]},
      "force_sensor": {"noise_N": 0.1},
      "substeps": 5, "seed": 9,
      "digital": [{"at_s": 1, "bits": 3}],
      "failures": [{"kind": "jump", "axis": "x", "at_s": 1, "for_s": 2, "size_m": 0.1, "size_rad": 0.1}]},
    "can": {"interface": "can0", "watchdog_s": 0.02, "timing": "in_phase", "bitrate_Hz": 500000,
            "data_bitrate_Hz": 2000000, "turnaround_s": 0.0002, "drive_delay_s": 0.0003,
            "estimates_every_s": 0.002, "heartbeat_every_s": 0.05, "host_id": 5, "prefix": 7,
            "ignore_position_bounds": true},
    "usb": {"id": "1234:0006", "serial": "s", "path": "1-2.3", "interface": 1, "usage": "ffab:0200",
            "transport": "libusb", "reads": 3, "arrival_age_s": 0.002, "max_age_s": 0.004, "send_s": 0.003,
            "drive_delay_s": 0.0002, "watchdog_s": 0.03, "silence_s": 0.2},
    "falcon": {"firmware": "f.bin", "sha256": "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef",
               "upload_tries": 3, "counts_per_Nm": 9000, "max_command": 5000, "flush_on_bracket": true},
    "report": {
      "in": {"id": 1, "bytes": 20,
             "positions": [{"offset_bits": 8, "width_bits": 16, "endian": "big", "scale": 2, "signed": true,
                            "float": true, "offset": 3, "unwrap": true, "modulus": 4096}],
             "buttons": [{"offset_bits": 24, "width_bits": 2}],
             "analogue": [{"offset_bits": 32, "width_bits": 8, "endian": "big", "scale": 2, "signed": true,
                           "float": true, "offset": 3}],
             "sequence": {"offset_bits": 40, "width_bits": 8, "endian": "big", "modulus": 200}},
      "out": {"id": 2, "bytes": 20,
              "efforts": [{"offset_bits": 8, "width_bits": 16, "endian": "big", "scale": 0.1, "signed": true,
                           "float": true, "offset": 3, "least": -1, "most": 1}],
              "constants": [{"byte": 4, "value": 7}],
              "heartbeat": {"offset_bits": 40, "width_bits": 8, "endian": "big"},
              "safe": [2, 0], "every_s": 0.01, "watchdog_s": 0.1}},
    "openffboard": {"full_torque_Nm": 3, "dead_man_s": 0.2},
    "kinematics": {"cartesian": {"directions": ["y"]}},
    "pose": {"position_m": [1, 2, 3], "rotation_quaternion": [0, 1, 0, 0]},
    "workspace_scale": 2,
    "tool_radius_m": 0.01,
    "axes": [{"name": "x", "kind": "rotary",
              "can": {"node": 3, "counts_per_turn": 4096, "interface": "can1", "max_current_A": 10,
                      "max_velocity_turns_s": 30},
              "encoder": {"counts_per_m": 1000, "counts_per_rev": 1000, "bits": 20, "offset_m": 0.1,
                          "offset_rad": 0.1, "reversed": true, "stuck_s": 1},
              "actuator": {"max_force_N": 9, "max_torque_Nm": 9, "continuous_force_N": 3,
                           "continuous_torque_Nm": 3, "thermal_time_s": 20},
              "model": {"file": "m.yaml", "mass_kg": 1, "inertia_kgm2": 1, "damping_Ns_m": 2, "damping_Nms_rad": 2,
                        "coulomb_N": 0.1, "coulomb_Nm": 0.1, "mass_uncertainty": 0.1, "damping_uncertainty": 0.2},
              "velocity": {"estimator": "foaw", "cutoff_Hz": 100, "window": 9, "degree": 3, "noise_counts": 2,
                           "bandwidth_rad_s": 700},
              "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
                           "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1,
                           "extra_delay_ticks": 1, "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1,
                           "i_know_it_cancels_the_hand": true},
              "compensation": {"viscous_share": 0.1, "coulomb_share": 0.1, "smooth_m_s": 0.1,
                               "smooth_rad_s": 0.1, "gravity_N": 1, "gravity_Nm": 1, "swing_Nm": 1,
                               "swing_phase_rad": 1},
              "homing": {"by": "index", "position_m": 0.1, "position_rad": 0.1, "search_force_N": 1,
                         "search_torque_Nm": 1, "search_velocity_m_s": 0.1, "search_velocity_rad_s": 0.1,
                         "still_s": 0.1, "timeout_s": 5},
              "travel": {"min_m": -1, "max_m": 1, "min_rad": -1, "max_rad": 1, "stiffness_N_m": 10,
                         "stiffness_Nm_rad": 10, "margin_m": 0.1, "margin_rad": 0.1, "max_force_N": 1,
                         "max_torque_Nm": 1}}],
    "contact": {
      "x": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}},
      "y": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}},
      "z": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}}},
    "gravity": {"tip_mass_kg": 1, "acceleration_m_s2": [0, 0, -9]},
    "force_sensor": {"directions": ["x"]},
    "enable_inputs": [{"bit": 1, "active": false, "role": "estop"}],
    "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_velocity_rad_s": 2, "max_slew_N_s": 3, "ramp_s": 4,
              "max_stale_ticks": 5, "max_power_W": 6, "workspace": {"min_m": [-1, -1, -1], "max_m": [1, 1, 1]},
              "passivity_controller": {"budget_J": 0.1, "damping_share": 0.1, "leak_s": 1}}}],
  "coupling": {
    "file": "c.yaml",
    "blocks": [{"contacts": ["a.x"], "stiffness_N_m": 2, "damping_Ns_m": 3,
                "state_space": {"A": [[0.5]], "B": [[1]], "C": [[1]], "D": [[2]]}}],
    "solver": {"max_sweeps": 7, "tolerance_N": 0.1}},
  "scene": [{"plane": {"normal": [0, 1, 0], "offset_m": 0.2}}],
  "sim": {"hand": {"contacts": ["a"], "velocity_m_s": [1],
                   "state_space": {"A": [[0.5]], "B": [[1]], "C": [[1]], "D": [[2]]}}},
  "stability": {"require": "none", "proof": "PROOF", "hand": {"mass_kg": [0, 1], "damping_Ns_m": [0, 2],
    "stiffness_N_m": [0, 300]}, "paper": {"hold": "second_order", "corner_rad_s": 3000, "damping_ratio": 0.7,
    "weight_numerator": [1], "weight_denominator": [0, 1]}},
  "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_velocity_rad_s": 2, "max_slew_N_s": 3, "ramp_s": 4,
              "max_stale_ticks": 5, "max_power_W": 6, "workspace": {"min_m": [-1, -1, -1], "max_m": [1, 1, 1]},
              "passivity_controller": {"budget_J": 0.1, "damping_share": 0.1, "leak_s": 1}},
  "control": {"socket": "/tmp/s"},
  "telemetry": {"flight_dir": "/tmp", "flight_s": 2, "record": "/tmp/r"}
})"));

/// The kinds of kinematics and of objects that kFull does not have, in full; surfaces without what
/// all of them have.
inline const json kOtherKinds = json::parse(R"({
  "five_bar": {"link_m": 0.2, "base_m": 0.1},
  "delta": {"a_m": 1, "b_m": 1, "c_m": 1, "d_m": 1, "e_m": 1, "f_m": 1, "r_m": 1, "s_m": 1,
            "legs_deg": [0, 120, 240], "home_m": [0, 0, 1]},
  "serial": {"joints": [{"theta_rad": 1, "d_m": 1, "a_m": 1, "alpha_rad": 1, "prismatic": true, "mass_kg": 1,
                         "center_m": [1, 1, 1]}]},
  "point": {"name": "w", "devices": ["a"], "stiffness_N_m": 1, "damping_Ns_m": 1, "range_m": 1,
            "center_m": [1, 1, 1]},
  "line": {"name": "w", "devices": ["a"], "stiffness_N_m": 1, "damping_Ns_m": 1, "range_m": 1,
           "center_m": [1, 1, 1], "axis": [1, 1, 1], "length_m": 1},
  "curve": {"name": "w", "devices": ["a"], "stiffness_N_m": 1, "damping_Ns_m": 1, "range_m": 1,
            "points_m": [[1, 1, 1], [2, 2, 2]], "closed": true},
  "viscous": {"name": "w", "devices": ["a"], "center_m": [1, 1, 1], "radius_m": 1, "damping_Ns_m": 1},
  "constant": {"name": "w", "devices": ["a"], "center_m": [1, 1, 1], "radius_m": 1, "force_N": [1, 1, 1]},
  "detents": {"name": "w", "devices": ["a"], "along": [1, 1, 1], "offset_m": 1, "spacing_m": 1,
              "max_force_N": 1, "count": 3},
  "magnet": {"name": "w", "devices": ["a"], "center_m": [1, 1, 1], "radius_m": 1, "range_m": 1,
             "max_force_N": 1},
  "vibration": {"name": "w", "devices": ["a"], "center_m": [1, 1, 1], "radius_m": 1, "force_N": [1, 1, 1],
                "frequency_Hz": 100, "phase_rad": 1},
  "network": {"name": "w",
              "nodes": [{"name": "m", "mass_kg": 1, "position_m": 1, "load_N": 1}],
              "elements": [{"between": ["a.y", "m"], "stiffness_N_m": 1, "damping_Ns_m": 1, "rest_m": 1}]}
})");
inline const json kOtherSurfaces = json::parse(R"({
  "texture": {"normal": [0, 1, 0], "offset_m": 1, "along": [1, 0, 0], "profile": "groove", "amplitude_m": 1,
              "wavelength_m": 1},
  "box": {"center_m": [1, 1, 1], "size_m": [1, 1, 1], "rotation_quaternion": [0, 1, 0, 0], "free": "inside"},
  "sphere": {"center_m": [1, 1, 1], "radius_m": 1, "free": "inside"},
  "cylinder": {"center_m": [1, 1, 1], "axis": [1, 0, 0], "radius_m": 1, "length_m": 1, "free": "inside"},
  "capsule": {"center_m": [1, 1, 1], "axis": [1, 0, 0], "radius_m": 1, "length_m": 1, "free": "inside"},
  "mesh": {"file": "f", "scale": 2, "position_m": [1, 1, 1], "rotation_quaternion": [0, 1, 0, 0],
           "max_triangles": 7}
})");

inline json other_kind(const std::string& key) {
  if (!kOtherSurfaces.contains(key)) return kOtherKinds.at(key);
  json kind = kOtherSurfaces[key];
  kind.update(kSurface);
  return kind;
}

}  // namespace hapticd::config::test
