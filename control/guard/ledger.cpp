#include "control/guard/ledger.h"

#include "control/plan.h"
#include "control/state.h"
#include "control/step.h"

namespace hapticd::control {

void book(const Plan&, State&, const TickInput&) noexcept {}

}  // namespace hapticd::control
