// `hapticctl simulate` and `hapticctl export`.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/simulate.h"

namespace hapticd::daemon {

/// Simulates a config file and prints how it went. no: forces stayed off, or it ended in a fault.
ExitCode run_simulate(const std::string& config_path, const SimulateOptions& options, bool json);

/// Writes a recording as CSV to `output`; empty: beside it, with .csv added; "-": standard output.
ExitCode run_export(const std::string& recording_path, std::string output, bool json);

}  // namespace hapticd::daemon
