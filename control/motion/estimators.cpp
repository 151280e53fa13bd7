#include "control/motion/estimators.h"

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

void estimate_velocity(const Plan&, State&) noexcept {}

}  // namespace hapticd::control
