// Broad phase: which objects a contact may meet. A list of those within `margin` of a point, which
// holds until the contact has gone `margin` from there (so nothing is looked for in most ticks),
// and is made anew from a tree of boxes. Objects far away cost nothing in a tick.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// Makes the list of the contact at `point` anew where it has to be. What is being touched stays
/// on it. The list, in the order of the plan: state.near[first_encounter ..].
void update_near(const Plan& plan, State& state, std::size_t contact, const Vec3& point) noexcept;

}  // namespace hapticd::control
