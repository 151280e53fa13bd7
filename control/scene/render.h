// The scene's force on every contact: one packed array per kind of object, an empty one costs a
// comparison.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Sets state.scene_force [N] from state.x and state.v.
void render(const Plan& plan, State& state) noexcept;

}  // namespace hapticd::control
