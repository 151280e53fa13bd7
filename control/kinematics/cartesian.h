// Cartesian devices: coordinate i of the contact is axis i, J is the identity.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// x = q, v = qd.
void forward(const Plan& plan, State& state) noexcept;

/// effort = J^T force.
void transpose(const Plan& plan, State& state) noexcept;

}  // namespace hapticd::control
