// Limits that only some devices name, one packed array each.
#pragma once
#include <cstdint>

namespace hapticd::control {

/// Mechanical power that the motors of a device may put out together, effort . qd.
struct PowerLimit {
  std::uint16_t device = 0;
  double max_W = 0;
};

/// Motor temperature by the square of the effort (i^2 t): heat h, 1 at the continuous rating held
/// for ever,
///
///   h' = ((effort / continuous)^2 - h) / time constant
///
/// From h = 0.9 on the effort's bound goes down linearly, from the actuator's to `continuous` at
/// h = 1; so h never passes 1.
struct ThermalPlan {
  std::uint16_t axis = 0;
  double continuous = 0;  ///< N or N m, > 0
  double share = 0;       ///< 1 - exp(-T / time constant)
};

/// A digital input that has to be as `active` says. A dead-man that is let go takes forces out by
/// the ramp, and lets them in again; an e-stop is Fault::estop.
struct EnableInput {
  std::uint16_t device = 0;
  std::uint32_t mask = 0;    ///< bits of Aux::digital
  std::uint32_t active = 0;  ///< (digital & mask) must equal this for forces
  bool estop = false;
};

}  // namespace hapticd::control
