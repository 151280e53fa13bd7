// Groups of devices as the papers' loops; what needs no design is in groups.h.
#pragma once
#include "control/design/synthesis/loop.h"
#include "daemon/groups.h"

namespace hapticd::daemon {

/// The paper's loop over all coordinates of the group.
inline synthesis::HapticLoop loop_of(const Group& group, double period_s) {
  return {.scene = group.model.E, .device_level = group.damping, .period_s = period_s};
}

}  // namespace hapticd::daemon
