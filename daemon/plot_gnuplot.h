// gnuplot as a child process.
#pragma once
#include <chrono>
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

inline constexpr std::chrono::milliseconds kGnuplotPatience{60'000};

/// What gnuplot writes to its standard output on this script. No shell, no start-up files of the
/// user. `program` is looked for in PATH. Errors: unavailable (it is not installed, or hangs and was
/// killed), software (it refuses the script, with its own words).
Result<std::string> run_gnuplot(const std::string& script, const std::string& program = "gnuplot",
                                std::chrono::milliseconds patience = kGnuplotPatience);

}  // namespace hapticd::daemon
