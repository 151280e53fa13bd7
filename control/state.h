// All that the loop changes, sized by the plan and preallocated by build::Program.
#pragma once
#include <cstdint>
#include <span>

#include "control/core/fault.h"

namespace hapticd::control {

/// Whether forces are on. Non-zero force only in `enabled`; it fades in and out by the ramp.
enum class Mode : std::uint8_t { idle = 0, enabled = 1, fault = 2 };

struct AxisState {
  double raw = 0;      ///< last raw value
  double unwrapped = 0;  ///< raw value counted on over every wrap
  double q = 0;        ///< m or rad
  double qd = 0;       ///< m/s or rad/s
  std::uint32_t stale_ticks = 0;
  std::uint32_t same_ticks = 0;  ///< ticks for which `raw` did not change at all under force (stuck watch)
  bool seeded = false;  ///< `raw` and `q` are of the tick before: a difference may be taken
};

struct State {
  std::span<AxisState> axes;
  std::span<double> x;            ///< m, contact coordinates
  std::span<double> v;            ///< m/s
  std::span<double> scene_force;  ///< N on the contacts, before any guard
  std::span<double> force;        ///< N on the contacts, after the guard; the slew limit starts from it
  std::span<double> effort;       ///< N or N m, per axis
  double ramp = 0;                ///< 0 to 1
  Mode mode = Mode::idle;
  bool adopted = false;           ///< first tick after carry_over()
  FaultReport fault;
};

}  // namespace hapticd::control
