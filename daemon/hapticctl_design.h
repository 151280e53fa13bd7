// `hapticctl design CONFIG -o FILE`: a coupling for the devices and the scene of a config, with what
// proves it.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/hapticctl_designer.h"

namespace hapticd::daemon {

/// What the config says of a coupling is not read. Writes the file once it is proved with it, and
/// prints what was found; progress goes to standard error.
ExitCode run_design(const std::string& path, const DesignOptions& options, bool json);

}  // namespace hapticd::daemon
