// Mode of the tick: idle, homing, enabled or fault.
//
// A fault that is found while forces are on (or wanted) takes every force to zero in the same tick,
// past ramp and slew limit, and stays until it is cleared. While idle only an e-stop and a device's
// own fault are kept: pushing a powerless device about is no fault.
#pragma once
#include "control/core/findings.h"
#include "control/step.h"

namespace hapticd::control {

/// Decides state.mode from the input and the findings so far, and findings.enable.
void decide_mode(const Plan& plan, State& state, const TickInput& input,
                 Findings& findings) noexcept;

/// Enters Mode::fault, unless there already.
void fail(State& state, const FaultReport& fault) noexcept;

/// Forces, efforts and ramps to zero.
void zero_force(State& state) noexcept;

}  // namespace hapticd::control
