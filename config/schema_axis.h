// One axis of a config. A key with a unit of length or force stands here twice, once for linear
// and once for rotary axes; config/axis_units.h takes the one that fits Axis::kind.
#pragma once
#include <optional>
#include <string>

namespace hapticd::config {

enum class AxisKind { linear, rotary };

struct Encoder {
  std::optional<double> counts_per_m;
  std::optional<double> counts_per_rev;
  int bits = 32;                   ///< the value wraps at 2^bits; 0: never
  std::optional<double> offset_m;  ///< position of the axis where the encoder reads 0; default 0
  std::optional<double> offset_rad;
  bool reversed = false;
  std::optional<double> stuck_s;  ///< watch for a stuck encoder; default: not watched
  bool operator==(const Encoder&) const = default;
};

struct Actuator {
  std::optional<double> max_force_N;
  std::optional<double> max_torque_Nm;
  std::optional<double> continuous_force_N;  ///< default: no limit by temperature
  std::optional<double> continuous_torque_Nm;
  double thermal_time_s = 30;
  bool operator==(const Actuator&) const = default;
};

struct AxisModel {
  std::optional<std::string> file{};  ///< a model file with what follows; gone once it is read
  std::optional<double> mass_kg{};
  std::optional<double> inertia_kgm2{};
  std::optional<double> damping_Ns_m{};
  std::optional<double> damping_Nms_rad{};
  std::optional<double> coulomb_N{};  ///< default 0
  std::optional<double> coulomb_Nm{};
  double mass_uncertainty = 0;  ///< share: true mass or inertia within (1 +- this)
  double damping_uncertainty = 0;
  bool operator==(const AxisModel&) const = default;
};

enum class Excited { stepped, chirp };
/// Where the figures of a model file come from.
struct Measurement {
  std::string device, axis;
  std::string at;  ///< UTC, "2026-01-02T03:04:05Z"
  Excited method = Excited::stepped;
  double rate_Hz = 0;
  double duration_s = 0;
  double from_Hz = 0, to_Hz = 0;
  double least_coherence = 0;           ///< over these frequencies
  std::optional<double> max_force_N{};  ///< bound of the excitation
  std::optional<double> max_torque_Nm{};
  double confidence = 0.99;  ///< of every interval
  double delay_s = 0;        ///< from sample to force
  double delay_uncertainty_s = 0;
  std::optional<double> coulomb_uncertainty{};  ///< share; none: no dry friction was found
  double residual_counts = 0;  ///< what the model does not explain, root mean square
  bool operator==(const Measurement&) const = default;
};
/// What `hapticctl identify` writes.
struct ModelFile {
  AxisModel model;  ///< without `file`
  std::optional<Measurement> measured{};
  bool operator==(const ModelFile&) const = default;
};

enum class Estimator { backward_difference, low_pass, least_squares, foaw, alpha_beta_gamma };
struct Velocity {
  Estimator estimator = Estimator::backward_difference;
  double cutoff_Hz = 200;
  int window = 8;
  int degree = 2;
  double noise_counts = 1;
  double bandwidth_rad_s = 800;
  bool operator==(const Velocity&) const = default;
};

enum class ObserverMode { off, model, sensor, classic };
/// Of an axis, or of a coordinate of a contact (linear).
struct Observer {
  ObserverMode mode = ObserverMode::off;
  int order = 2;
  double cutoff_Hz = 10;
  std::optional<double> nominal_mass_kg;  ///< default: the model's
  std::optional<double> nominal_inertia_kgm2;
  std::optional<double> nominal_damping_Ns_m;  ///< default: the model's
  std::optional<double> nominal_damping_Nms_rad;
  int extra_delay_ticks = 0;
  double blend_s = 0.5;
  std::optional<double> max_force_N;  ///< default: the actuator's; of a contact: the guard's
  std::optional<double> max_torque_Nm;
  bool i_know_it_cancels_the_hand = false;
  bool operator==(const Observer&) const = default;
};

struct Compensation {
  double viscous_share = 0;
  double coulomb_share = 0;
  std::optional<double> smooth_m_s;  ///< default: from what the viscous share leaves
  std::optional<double> smooth_rad_s;
  std::optional<double> gravity_N;  ///< default 0
  std::optional<double> gravity_Nm;
  double swing_Nm = 0;
  double swing_phase_rad = 0;
  bool operator==(const Compensation&) const = default;
};

enum class HomingMethod { none, device, index, hard_stop };
struct Homing {
  HomingMethod by = HomingMethod::none;
  std::optional<double> position_m;  ///< default 0
  std::optional<double> position_rad;
  std::optional<double> search_force_N;  ///< signed; default 0: a hand moves the axis
  std::optional<double> search_torque_Nm;
  std::optional<double> search_velocity_m_s;    ///< default 0.05
  std::optional<double> search_velocity_rad_s;  ///< default 0.5
  double still_s = 0.2;
  double timeout_s = 20;
  bool operator==(const Homing&) const = default;
};

struct Travel {
  std::optional<double> min_m, max_m;
  std::optional<double> min_rad, max_rad;
  std::optional<double> stiffness_N_m;  ///< default 0: no spring, only the fault
  std::optional<double> stiffness_Nm_rad;
  std::optional<double> margin_m;
  std::optional<double> margin_rad;
  std::optional<double> max_force_N;  ///< default: the actuator's
  std::optional<double> max_torque_Nm;
  bool operator==(const Travel&) const = default;
};

/// The drive of an axis on a CAN bus.
struct CanDrive {
  int node = 0;
  double counts_per_turn = 0;               ///< of the motor's encoder
  std::optional<std::string> interface {};  ///< default: the device's
  std::optional<double> max_current_A{};    ///< odrive; default: as set in the drive
  std::optional<double>
      max_velocity_turns_s{};  ///< odrive, with max_current_A; default: twice the guard's
  bool operator==(const CanDrive&) const = default;
};

struct Axis {
  std::string name;
  AxisKind kind = AxisKind::linear;
  Encoder encoder;
  Actuator actuator;
  std::optional<AxisModel> model;
  Velocity velocity;
  Observer observer;
  Compensation compensation;
  Homing homing;
  std::optional<Travel> travel;
  std::optional<CanDrive> can;  ///< with a driver for CAN
  bool operator==(const Axis&) const = default;
};

}  // namespace hapticd::config
