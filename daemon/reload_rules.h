// What a reload may change under a running loop, and what needs a restart. Pure.
#pragma once
#include <string>
#include <vector>

#include "config/compile.h"

namespace hapticd::daemon {

/// One line for each key that a running daemon cannot change, with the words "disable first";
/// empty: the new config may be adopted. Scene, guard, models, estimators, stability, start and
/// telemetry may change, and latency within a tick.
std::vector<std::string> reload_obstacles(const config::Compiled& running,
                                          const config::Compiled& fresh);

/// The same for the whole ticks of latency, which only the compiled program tells: ledger and
/// observers hold efforts by their age.
std::vector<std::string> latency_obstacles(const build::ProgramSpec& running,
                                           const build::ProgramSpec& fresh);

}  // namespace hapticd::daemon
