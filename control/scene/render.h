// The scene's force on every contact: one packed array per kind of object, an empty one costs a
// comparison.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// What the springs that the device's contact touches would give back [J].
double stored_energy(const Plan& plan, const State& state, const DevicePlan& device) noexcept;

/// Sets state.scene_force [N] from state.x and state.v.
void render(const Plan& plan, State& state) noexcept;

}  // namespace hapticd::control
