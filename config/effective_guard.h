// The limits that hold for a device: its own, else the global ones, else what follows from the
// device.
#pragma once
#include <optional>

#include "config/schema.h"

namespace hapticd::config {

struct EffectiveGuard {
  double max_force_N = 0;  ///< NaN: nobody says, and it does not follow (linkages)
  double max_velocity_m_s = 0;
  double max_velocity_rad_s = 0;
  double max_slew_N_s = 0;
  double ramp_s = 0;
  int max_stale_ticks = 0;
  std::optional<double> max_power_W;
  std::optional<WorkspaceBox> workspace;
  std::optional<PassivityController> passivity_controller;
};

EffectiveGuard effective_guard(const Guard& global, const Device& device);

/// Of its linear axes; infinity where there are none.
double smallest_actuator_N(const Device& device);

}  // namespace hapticd::config
