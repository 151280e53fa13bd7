// How an axis learns where it is. Axes with an absolute encoder, or with a fixed offset from where
// they are at power-on, are not in plan.homings: they are homed by their first sample.
//
//   device     the driver's AxisSample::homed says that raw values are absolute
//   index      raw value at the index pulse, found by hand or by a search
//   hard_stop  the mechanical stop, found by a search
//
// A search moves one axis at a time, in Mode::homing, with an effort that grows slowly up to
// `effort` and gives way above `velocity`: bounded force, bounded speed. Standing still under full
// effort is the stop. A search for an index turns round at a stop, once.
#pragma once
#include <cstdint>

#include "control/core/findings.h"

namespace hapticd::control {

struct Plan;
struct State;
struct TickInput;

enum class HomingBy : std::uint8_t { device, index, hard_stop };

struct HomingPlan {
  std::uint16_t axis = 0;
  HomingBy by = HomingBy::device;
  double position = 0;  ///< m or rad: q at the index or at the stop
  double effort = 0;    ///< N or N m, signed: towards the stop; 0: nobody drives, a hand does
  double effort_per_tick = 0;     ///< N or N m, > 0: growth of the search effort
  double velocity = 0;            ///< m/s or rad/s, > 0: the search gives way above it
  std::uint32_t still_ticks = 0;  ///< standing for so long under full effort is a stop
  std::uint32_t max_ticks = 0;    ///< a search that takes longer is a fault
};

struct HomingState {
  double effort = 0;  ///< N or N m now
  double from = 0;    ///< m or rad: q when the axis was last seen to move
  std::uint32_t ticks = 0;
  std::uint32_t still = 0;
  bool turned = false;
  bool done = false;
};

/// Takes over references that were found: shifts q of the axis, marks it homed and reseeded. Sets
/// findings.homed. Advances the search in Mode::homing; reports Fault::homing.
void home(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept;

}  // namespace hapticd::control
