// `hapticctl certify CONFIG [-o FILE]`: is it stable, by how much, and what is not covered.
#pragma once
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

/// Prints the answers `passive` (what the daemon goes by), `exact` (this linear scene alone),
/// `robust` and `paper` (Theorem 3 as published). `output`: a file that gets what proves the robust answers, for
/// stability.proof, found anew; empty: none. Exit: ok where what is demanded is proved or the file was written, else no.
ExitCode run_certify(const std::string& path, const std::string& output, bool json);

}  // namespace hapticd::daemon
