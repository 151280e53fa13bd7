// What stands between a healthy loop and forces, in words that say what to do. Pure.
#pragma once
#include <string>
#include <vector>

#include "control/build/program.h"
#include "daemon/live.h"

namespace hapticd::daemon {

/// One line for each enable input that is not as it has to be and each axis that is not homed.
/// `device_words`: by device, what it is about while it gives no samples; its axes are then not named. Empty: nothing, or
/// nothing is known yet.
std::vector<std::string> waiting_for(const build::ProgramSpec& spec, const LiveView& now,
                                     const std::vector<std::string>& device_words = {});

}  // namespace hapticd::daemon
