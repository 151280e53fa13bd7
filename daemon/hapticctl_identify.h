// `hapticctl identify CONFIG --device D --axis A -o FILE`: what an axis is made of, as a model file for
// the config; with --hand what the hand on it is like.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/hapticctl_identify_setup.h"

namespace hapticd::daemon {

/// Moves the axis, fits, prints, and writes the file when all is known: a run that is interrupted or
/// fails leaves an older file as it was. Progress goes to standard error. Ends with: no (a bound was
/// exceeded, the data tell nothing), usage, bad_data, unavailable, cannot_create, try_again
/// (interrupted, or hapticd has the device).
ExitCode run_identify(const std::string& config_path, const IdentifyOptions& options, bool json);

}  // namespace hapticd::daemon
