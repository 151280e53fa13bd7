// The force limit of coupled contacts: a slack s between contact and coupling that costs F_max |s|,
// so that no force is larger than F_max and every force is still a slope of the scene's energy. A
// clip after the solve is not: it gave 12 mJ per loop in a corner.
#pragma once
#include "control/scene/together.h"

namespace hapticd::control {

/// A little less than the device's limit, so that the guard's clip stays away [N].
double force_limit(const ContactPlan& contact) noexcept;

/// Solves the group with the least slack that keeps every contact within its limit.
void solve_within_limits(Together& together) noexcept;

}  // namespace hapticd::control
