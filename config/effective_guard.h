// The limits that hold for a device: its own, else the global ones, else what follows from the
// device.
#pragma once
#include "config/schema.h"

namespace hapticd::config {

struct EffectiveGuard {
  double max_force_N = 0;
  double max_velocity_m_s = 0;
  double max_slew_N_s = 0;
  double ramp_s = 0;
  int max_stale_ticks = 0;
};

EffectiveGuard effective_guard(const Guard& global, const Device& device);

/// 0 for a device without axes.
double smallest_actuator_N(const Device& device);

}  // namespace hapticd::config
