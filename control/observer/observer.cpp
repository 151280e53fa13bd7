#include "control/observer/observer.h"

namespace hapticd::control {

double observe(const ObserverPlan&, ObserverState&, Motion, double, double, double) noexcept {
  return 0;
}

}  // namespace hapticd::control
