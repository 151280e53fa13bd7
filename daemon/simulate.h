// `hapticctl simulate`: the daemon's own tick in virtual time, every record into a file. Only
// simulated devices can.
#pragma once
#include <atomic>
#include <cstdint>
#include <string>

#include "config/compile.h"
#include "control/core/fault.h"
#include "control/core/result.h"

namespace hapticd::daemon {

struct SimulateOptions {
  double duration_s = 0;  ///< of virtual time
  std::string output;     ///< the recording
  bool unproven = false;  ///< enable although stability.require is not met
};

struct SimulateResult {
  std::int64_t ticks = 0;
  double simulated_s = 0;
  double wall_s = 0;
  double largest_force_N = 0;
  FaultReport fault;     ///< the loop stood in it at the end
  bool enabled = false;  ///< forces were asked for
  bool interrupted = false;
};

/// Enables once every device is ready, unless stability refuses. The same config gives the same
/// file to the bit. Ends early, with a whole file, when `interrupt` becomes true. Errors: usage (a
/// real device), output file.
Result<SimulateResult> simulate(config::Compiled& compiled, const SimulateOptions& options,
                                const std::atomic<bool>& interrupt);

}  // namespace hapticd::daemon
