// `hapticctl emulate`: stands in for the CAN drives of a config on real interfaces, virtual ones above all, so that the
// daemon runs as it will beside the hardware.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "control/core/result.h"

namespace hapticd::daemon {

struct EmulateOptions {
  std::string config{};
  std::string bus{};  ///< this interface alone; empty: all of the config
  bool real = false;  ///< on a real controller, too
  std::optional<double> duration_s{};
  double loss = 0, duplicate = 0;  ///< shares of the frames, in each direction
  double delay_s = 0, jitter_s = 0;
  double drift_ppm = 0;               ///< of the drives' clocks
  std::vector<std::string> faults{};  ///< "reset:left.x@2.5", seconds from the start
};

/// Until the duration, SIGINT or SIGTERM.
ExitCode run_emulate(const EmulateOptions& options, bool json);

}  // namespace hapticd::daemon
