// The last word on every force: mode, ramp, force limit, slew limit, finite check, actuator limit.
//
// A fault that is found while forces are on (or wanted) takes every force to zero in the same tick,
// past ramp and slew limit, and stays until it is cleared. While idle only an e-stop and a device's
// own fault are kept: pushing a powerless device about is no fault.
//
// Both limits keep the direction of what they cut, and both sets are convex, so no order of them
// leaves the other's.
#pragma once
#include "control/core/findings.h"
#include "control/step.h"

namespace hapticd::control {

/// Decides state.mode from the input and the findings so far.
void decide_mode(State& state, const TickInput& input, const Findings& findings) noexcept;

/// state.scene_force -> state.force [N].
void guard(const Plan& plan, State& state, Findings& findings, bool enable) noexcept;

/// Cuts state.effort at what the actuators deliver; zero and a fault if any of it is not finite.
void limit_effort(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
