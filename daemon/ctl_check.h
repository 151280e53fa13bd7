// `hapticctl check FILE` and `hapticd --check`: is this config valid, what does it compile to, may
// forces be enabled?
#pragma once
#include <string>
#include <vector>

#include "config/error.h"
#include "control/core/result.h"

namespace hapticd::daemon {

/// ok: valid, and forces may be enabled; no: valid, but the daemon would keep forces off; else why
/// the file is refused.
ExitCode check_config(const std::string& path, bool json);

/// Prints every error of a file; the code to end with.
ExitCode print_config_errors(const std::vector<config::ConfigError>& errors, bool json);

}  // namespace hapticd::daemon
