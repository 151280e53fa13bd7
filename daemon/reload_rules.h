// What a reload may change under a running loop, and what needs a restart. Pure.
#pragma once
#include <string>
#include <vector>

#include "config/compile.h"

namespace hapticd::daemon {

/// One line for each key that a running daemon cannot change, with the words "disable first";
/// empty: the new config may be adopted. Scene, guard, models, latency, stability, start and
/// telemetry may change.
std::vector<std::string> reload_obstacles(const config::Compiled& running,
                                          const config::Compiled& fresh);

}  // namespace hapticd::daemon
