// The scene's force on every contact: one packed array per kind of object, an empty one costs a
// comparison. Planes that need nothing more are rendered here; all else is solved together with the
// coupling (solve.h).
#pragma once
#include "control/core/findings.h"
#include "control/step.h"

namespace hapticd::control {

/// What the springs that the device's contact touches would give back [J].
double stored_energy(const Plan& plan, const State& state, const DevicePlan& device) noexcept;

/// Sets state.scene_force [N] from state.x and state.v, and moves the proxies.
void render(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept;

}  // namespace hapticd::control
