// `hapticctl design CONFIG --proof robust -o FILE`: the damping of the one wall that is rendered directly, or of the
// coupling of one axis, and what proves the loop with it for all devices, hands and latencies that the config gives.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/hapticctl_designer.h"

namespace hapticd::daemon {

/// Of a wall: the damper whose largest index J over all cases is least, J being the distance to the wall that the
/// config means. Of a coupling: the one whose slowest motion decays fastest. Prints it, and writes the proof file once
/// the daemon's own check has accepted it. Errors: no (none is stable, or none is proved), bad_data.
ExitCode run_design_robust(const std::string& path, const DesignOptions& options, bool json);

}  // namespace hapticd::daemon
