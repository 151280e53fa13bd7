// Bodies and fields of a group, found by sweeps (see solve.h).
#pragma once
#include "control/scene/together.h"

namespace hapticd::control {

/// Sets proxies, forces and EncounterState::next for the members' slack.
void sweep(Together& together) noexcept;

}  // namespace hapticd::control
