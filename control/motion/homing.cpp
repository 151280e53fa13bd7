#include "control/motion/homing.h"

#include "control/plan.h"
#include "control/state.h"
#include "control/step.h"

namespace hapticd::control {

void home(const Plan&, State&, const TickInput&, Findings&) noexcept {}

}  // namespace hapticd::control
