// From contact forces and compensations to the efforts that devices get:
//
//   J' (force + observer_force) + gravity + friction + observer + travel
//     -> finite check -> temperature -> actuator limit -> power -> effort
//
// Compensations are ramped and faded like the force. In Mode::homing the effort is the search's.
#pragma once
#include "control/core/findings.h"
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Fills state.effort; zero and Fault::output_not_finite if any of it is not finite.
void actuate(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
