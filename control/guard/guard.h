// From the scene's force to the force that a contact gets:
//
//   scene_force -> ramp -> force limit -> slew limit -> fade -> force
//
// Both limits keep the direction of what they cut, and both sets are convex, so no order of them
// leaves the other's. The fade is what has to act at once: near a singular pose, on stale samples,
// and where the passivity controller says so; it falls freely and rises no faster than the ramp.
#pragma once
#include "control/core/findings.h"
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// state.scene_force -> state.force [N]; zero unless Mode::enabled.
void guard(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
