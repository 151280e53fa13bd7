// One device of a config: its kinematics, where it stands, what it measures, its limits.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "config/schema_axis.h"
#include "config/schema_sim.h"
#include "config/schema_usb.h"

namespace hapticd::config {

enum class Direction { x, y, z };
struct Cartesian {
  std::vector<Direction> directions;
  bool operator==(const Cartesian&) const = default;
};
struct FiveBar {
  double link_m = 0;
  double base_m = 0;
  bool operator==(const FiveBar&) const = default;
};
/// The defaults are the Novint Falcon's.
struct Delta {
  double a_m = 0.060, b_m = 0.1025, c_m = 0.01443, d_m = 0.01125, e_m = 0.01125, f_m = -0.025;
  double r_m = 0.0400, s_m = -0.02309;
  std::array<double, 3> legs_deg{105, -15, -135};
  std::array<double, 3> home_m{0, 0, 0.11};
  bool operator==(const Delta&) const = default;
};
struct SerialJoint {
  double theta_rad = 0;
  double d_m = 0;
  double a_m = 0;
  double alpha_rad = 0;
  bool prismatic = false;
  double mass_kg = 0;
  std::array<double, 3> center_m{};
  bool operator==(const SerialJoint&) const = default;
};
struct Serial {
  std::vector<SerialJoint> joints;
  bool operator==(const Serial&) const = default;
};
/// A map with one key, the kind.
using Kinematics = std::variant<Cartesian, FiveBar, Delta, Serial>;

struct Pose {
  std::array<double, 3> position_m{};
  std::array<double, 4> rotation_quaternion{1, 0, 0, 0};  ///< w, x, y, z
  bool operator==(const Pose&) const = default;
};

struct ContactModel {
  double mass_kg = 0;
  double damping_Ns_m = 0;
  bool operator==(const ContactModel&) const = default;
};
struct ContactCoordinate {
  ContactModel model;
  Observer observer;
  bool operator==(const ContactCoordinate&) const = default;
};
struct Contact {
  std::optional<ContactCoordinate> x, y, z;
  bool operator==(const Contact&) const = default;
};

struct Gravity {
  double tip_mass_kg = 0;
  std::array<double, 3> acceleration_m_s2{0, 0, -9.81};
  bool operator==(const Gravity&) const = default;
};

struct ForceSensor {
  std::vector<Direction> directions;
  bool operator==(const ForceSensor&) const = default;
};

enum class InputRole { dead_man, estop };
struct EnableInput {
  int bit = 0;
  bool active = true;
  InputRole role = InputRole::dead_man;
  bool operator==(const EnableInput&) const = default;
};

struct WorkspaceBox {
  std::array<double, 3> min_m{};
  std::array<double, 3> max_m{};
  bool operator==(const WorkspaceBox&) const = default;
};
struct PassivityController {
  double budget_J = 0.002;
  double damping_share = 0.5;
  std::optional<double> leak_s;  ///< default: the reserve is never forgotten
  bool operator==(const PassivityController&) const = default;
};

/// Limits; a device's own guard overrides the global one key by key.
struct Guard {
  std::optional<double> max_force_N;  ///< default of a Cartesian device: its weakest actuator's
  std::optional<double> max_velocity_m_s;                   ///< default 1.5
  std::optional<double> max_velocity_rad_s;                 ///< default 10
  std::optional<double> max_slew_N_s;                       ///< default: max_force_N / 5 ms
  std::optional<double> ramp_s;                             ///< default 0.5
  std::optional<int> max_stale_ticks;                       ///< default 3
  std::optional<double> max_power_W;                        ///< default: no limit
  std::optional<WorkspaceBox> workspace;                    ///< default: no limit
  std::optional<PassivityController> passivity_controller;  ///< default: none
  bool operator==(const Guard&) const = default;
};

enum class Driver { sim, odrive, moteus, cia402, falcon, hid_report, openffboard };
enum class CanTiming { in_phase, free_running, reply_to_command };
/// The bus of a device of CAN drives.
struct CanBus {
  std::string interface;
  double watchdog_s = 0;
  std::optional<CanTiming> timing;  ///< default: the driver's
  double bitrate_Hz = 1e6;
  double data_bitrate_Hz = 5e6;  ///< moteus
  double turnaround_s = 1e-4;
  double drive_delay_s = 1e-4;
  double estimates_every_s = 1e-3;      ///< odrive
  double heartbeat_every_s = 0.1;       ///< odrive, cia402
  int host_id = 0;                      ///< moteus: 0 to 127; cia402: 1 to 127, 0 stands for 127
  int prefix = 0;                       ///< moteus
  bool ignore_position_bounds = false;  ///< moteus
  bool operator==(const CanBus&) const = default;
};
struct Device {
  std::string name;
  Driver driver = Driver::sim;
  std::optional<Sim> sim;        ///< of a simulated or emulated device
  std::optional<CanBus> can;     ///< with a driver for CAN
  std::optional<UsbDevice> usb;  ///< with one for USB; default: as its keys say, without `id` none
  std::optional<Falcon> falcon;
  std::optional<Report> report;  ///< of a hid_report
  std::optional<OpenFfboard> openffboard;
  Kinematics kinematics;
  Pose pose;
  double workspace_scale = 1;
  double tool_radius_m = 0;
  double latency_s = 0;
  std::vector<Axis> axes;
  Contact contact;
  std::optional<Gravity> gravity;
  std::optional<ForceSensor> force_sensor;
  std::vector<EnableInput> enable_inputs;
  Guard guard;
  bool operator==(const Device&) const = default;
};

}  // namespace hapticd::config
