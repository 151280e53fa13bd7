// `hapticctl certify CONFIG`: is it stable, by how much, and what is not covered.
#pragma once
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

/// Prints the answers `passive` (what the daemon goes by), `exact` (this linear scene alone),
/// `robust` and `paper` (Theorem 3 as published). Exit: ok where every device is proved, else no.
ExitCode run_certify(const std::string& path, bool json);

}  // namespace hapticd::daemon
