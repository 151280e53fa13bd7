// What a scene keeps when the plan is swapped under a running loop.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Proxies go on from where they are; coupling and networks too, where both plans have them in the
/// same form. What is touched is found anew from there, so friction lets go once. A force that steps
/// by it is ramped by the guard.
void carry_scene(const Plan& from_plan, const State& from, const Plan& to_plan, State& to) noexcept;

}  // namespace hapticd::control
