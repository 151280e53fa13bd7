// A config as plain structs, as written in the file: units of the file, defaults beside each field.
// `describe` in config/describe.h names each key, its range and what it is for; the reader, the
// JSON schema and the man page follow it.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace hapticd::config {

struct Loop {
  double rate_Hz = 1000;
  int priority = 80;
  std::optional<int> cpu;  ///< pin the servo thread to this CPU
  int max_gap_ticks = 5;
  int max_missed_per_s = 20;
  bool operator==(const Loop&) const = default;
};

enum class EnableWhen { on_command, when_ready };
struct Start {
  EnableWhen enable = EnableWhen::on_command;
  bool operator==(const Start&) const = default;
};

struct Encoder {
  double counts_per_m = 0;
  int bits = 32;        ///< the value wraps at 2^bits; 0: never
  double offset_m = 0;  ///< position of the axis where the encoder reads 0
  bool reversed = false;
  std::optional<double> stuck_s;  ///< watch for a stuck encoder; default: not watched
  bool operator==(const Encoder&) const = default;
};

struct Actuator {
  double max_force_N = 0;
  bool operator==(const Actuator&) const = default;
};

struct AxisModel {
  double mass_kg = 0;
  double damping_Ns_m = 0;
  double mass_uncertainty = 0;  ///< share: true mass within mass_kg (1 +- this)
  double damping_uncertainty = 0;
  bool operator==(const AxisModel&) const = default;
};

enum class AxisKind { linear };
enum class Estimator { backward_difference };
struct Velocity {
  Estimator estimator = Estimator::backward_difference;
  bool operator==(const Velocity&) const = default;
};
enum class ObserverMode { off };
struct Observer {
  ObserverMode mode = ObserverMode::off;
  bool operator==(const Observer&) const = default;
};

struct Axis {
  std::string name;
  AxisKind kind = AxisKind::linear;
  Encoder encoder;
  Actuator actuator;
  std::optional<AxisModel> model;
  Velocity velocity;
  Observer observer;
  bool operator==(const Axis&) const = default;
};

enum class Direction { x, y, z };
struct Cartesian {
  std::vector<Direction> directions;
  bool operator==(const Cartesian&) const = default;
};
struct Kinematics {
  Cartesian cartesian;
  bool operator==(const Kinematics&) const = default;
};

struct SimAxis {
  std::optional<double> mass_kg;       ///< default: model.mass_kg
  std::optional<double> damping_Ns_m;  ///< default: model.damping_Ns_m
  double coulomb_N = 0;
  double delay_s = 0;
  double position_m = 0;
  double noise_counts = 0;
  double dac_step_N = 0;
  bool operator==(const SimAxis&) const = default;
};
struct SimScriptStep {
  double at_s = 0;
  double force_N = 0;
  double position_m = 0;
  bool operator==(const SimScriptStep&) const = default;
};
struct SimHand {
  double mass_kg = 0;
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  std::vector<SimScriptStep> script;
  bool operator==(const SimHand&) const = default;
};
enum class SimFailureKind { nan, stuck, jump, missing, disarm, fault, slow };
struct SimFailure {
  SimFailureKind kind = SimFailureKind::nan;
  std::optional<std::string> axis;  ///< default: the first
  double at_s = 0;
  double for_s = 0;
  double size_m = 0;
  bool operator==(const SimFailure&) const = default;
};
struct Sim {
  std::vector<SimAxis> axes;  ///< empty: every axis as its model says
  SimHand hand;
  int substeps = 10;
  std::uint32_t seed = 1;
  std::vector<SimFailure> failures;
  bool operator==(const Sim&) const = default;
};

/// Limits; a device's own guard overrides the global one key by key.
struct Guard {
  std::optional<double> max_force_N;  ///< default: the smallest actuator.max_force_N of the device
  std::optional<double> max_velocity_m_s;  ///< default 1.5
  std::optional<double> max_slew_N_s;      ///< default: max_force_N / 5 ms
  std::optional<double> ramp_s;            ///< default 0.5
  std::optional<int> max_stale_ticks;      ///< default 3
  bool operator==(const Guard&) const = default;
};

enum class Driver { sim };
struct Device {
  std::string name;
  Driver driver = Driver::sim;
  std::optional<Sim> sim;  ///< only with driver: sim
  Kinematics kinematics;
  double latency_s = 0;
  std::vector<Axis> axes;
  Guard guard;
  bool operator==(const Device&) const = default;
};

struct Plane {
  std::string name;
  std::vector<std::string> devices;  ///< empty: all
  std::array<double, 3> normal{};    ///< towards the free side; any length but 0
  double offset_m = 0;  ///< distance of the surface from the origin along the unit normal
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;
  bool operator==(const Plane&) const = default;
};
/// A scene entry is a map with one key, the kind.
using SceneObject = std::variant<Plane>;

enum class Require { passive, none };
struct Stability {
  Require require = Require::passive;
  bool operator==(const Stability&) const = default;
};

struct Control {
  std::string socket = "/run/hapticd/hapticd.sock";
  bool operator==(const Control&) const = default;
};

struct Telemetry {
  std::string flight_dir = "/var/lib/hapticd";  ///< empty: no flight recorder
  double flight_s = 5;                ///< seconds before a fault that the flight recorder keeps
  std::optional<std::string> record;  ///< file that gets every record, in full
  bool operator==(const Telemetry&) const = default;
};

struct Config {
  int version = 1;
  Loop loop;
  Start start;
  std::vector<Device> devices;
  std::vector<SceneObject> scene;
  Stability stability;
  Guard guard;
  Control control;
  Telemetry telemetry;
  bool operator==(const Config&) const = default;
};

}  // namespace hapticd::config
