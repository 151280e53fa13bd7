// All that the loop changes, sized by the plan and preallocated by build::Program.
#pragma once
#include <cstdint>
#include <span>

#include "control/core/fault.h"

namespace hapticd::control {

/// Whether forces are on. Non-zero force only in `enabled`; it fades in and out by the ramp.
enum class Mode : std::uint8_t { idle = 0, enabled = 1, fault = 2 };

struct AxisState {
  double raw = 0;                 ///< last raw value
  double unwrapped = 0;           ///< raw value counted on over every wrap
  double counts = 0;              ///< what this tick added to it
  std::uint32_t stale_ticks = 0;  ///< ticks since the last fresh sample
  std::uint32_t still_ticks = 0;  ///< ticks under force without any change of `raw` (stuck watch)
  bool seeded = false;            ///< a fresh value was seen: q is known
};

struct State {
  std::span<AxisState> axes;
  std::span<double> q;            ///< m or rad, per axis
  std::span<double> qd;           ///< m/s or rad/s, per axis
  std::span<double> effort;       ///< N or N m, per axis
  std::span<double> x;            ///< m, contact coordinates
  std::span<double> scene_force;  ///< N on the contacts, before any guard
  std::span<double> force;  ///< N on the contacts, after the guard; the slew limit starts from it
  std::span<const double>
      recorded;            ///< q to force in one block, in this order: a record copies it whole
  std::span<double> v;     ///< m/s, contact coordinates
  std::span<double> ramp;  ///< 0 to 1, per device: share of the force that is let through
  Mode mode = Mode::idle;
  bool adopted = false;  ///< first tick after carry_over()
  FaultReport fault;
};

}  // namespace hapticd::control
