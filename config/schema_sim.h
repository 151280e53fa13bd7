// The truth of a simulated device, with the rotary forms of its keys as in schema_axis.h.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/schema_coupling.h"

namespace hapticd::config {

struct SimAxis {
  std::optional<double> mass_kg;  ///< default: as the model says
  std::optional<double> inertia_kgm2;
  std::optional<double> damping_Ns_m;  ///< default: as the model says
  std::optional<double> damping_Nms_rad;
  std::optional<double> coulomb_N;  ///< default 0
  std::optional<double> coulomb_Nm;
  double delay_s = 0;
  std::optional<double> position_m;  ///< default 0
  std::optional<double> position_rad;
  double noise_counts = 0;
  std::optional<double> dac_step_N;  ///< default 0
  std::optional<double> dac_step_Nm;
  bool relative = false;
  std::optional<double> index_m;  ///< default: the encoder has none
  std::optional<double> index_rad;
  std::optional<std::array<double, 2>> stops_m;  ///< default: the axis moves freely
  std::optional<std::array<double, 2>> stops_rad;
  double homed_at_s = 0;
  bool operator==(const SimAxis&) const = default;
};

/// What moves beside the axes of a linkage.
struct SimLinkage {
  double inner_link_kg = 0;
  double outer_link_kg = 0;
  double tip_kg = 0;
  std::array<double, 3> gravity_m_s2{};
  bool operator==(const SimLinkage&) const = default;
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
  std::array<double, 3> direction{1, 0, 0};  ///< of a linkage's hand; any length but 0
  std::vector<SimScriptStep> script;
  bool operator==(const SimHand&) const = default;
};

struct SimForceSensor {
  double noise_N = 0;
  bool operator==(const SimForceSensor&) const = default;
};

enum class SimFailureKind { nan, stuck, jump, missing, disarm, fault, slow };
struct SimFailure {
  SimFailureKind kind = SimFailureKind::nan;
  std::optional<std::string> axis;  ///< default: the first
  double at_s = 0;
  double for_s = 0;
  std::optional<double> size_m;  ///< default 0
  std::optional<double> size_rad;
  bool operator==(const SimFailure&) const = default;
};

struct SimDigitalStep {
  double at_s = 0;
  std::uint32_t bits = 0;
  bool operator==(const SimDigitalStep&) const = default;
};

struct Sim {
  std::vector<SimAxis> axes;  ///< empty: every axis as its model says
  SimLinkage linkage;
  SimHand hand;
  std::optional<SimForceSensor> force_sensor;  ///< default: exact, if the device has one
  int substeps = 10;
  std::uint32_t seed = 1;
  std::vector<SimDigitalStep> digital;
  std::vector<SimFailure> failures;
  bool operator==(const Sim&) const = default;
};

/// One hand, or several that know of each other, at contacts of several devices: from their
/// velocities to the forces against them.
struct SharedHand {
  std::vector<std::string> contacts;  ///< "left" or "left.x"
  StateSpace state_space;
  std::vector<double> velocity_m_s;  ///< empty: at rest
  bool operator==(const SharedHand&) const = default;
};
/// What simulated devices share.
struct Simulation {
  std::optional<SharedHand> hand;
  bool operator==(const Simulation&) const = default;
};

}  // namespace hapticd::config
