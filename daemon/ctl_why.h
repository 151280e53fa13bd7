// `hapticctl why FILE`: the last fault of a recording, as sentences that a person can act on.
#pragma once
#include <string>

#include "control/core/result.h"
#include "daemon/protocol.h"
#include "daemon/why.h"

namespace hapticd::daemon {

std::string why_text(const Why& why);
Json why_json(const Why& why);

/// Reads and prints; ok whether or not there was a fault.
ExitCode run_why(const std::string& recording_path, bool json);

}  // namespace hapticd::daemon
