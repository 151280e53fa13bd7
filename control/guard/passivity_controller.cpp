#include "control/guard/passivity_controller.h"

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

void control_passivity(const Plan&, State&, Findings&) noexcept {}

}  // namespace hapticd::control
