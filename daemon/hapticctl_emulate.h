// `hapticctl emulate`: stands in for the drives and devices of a config on this machine's own CAN and USB, so that the
// daemon runs as it will beside the hardware.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "control/core/result.h"

namespace hapticd::daemon {

struct EmulateOptions {
  std::string config{};
  std::string bus{};  ///< CAN: this interface alone; empty: all of the config
  bool real = false;  ///< CAN: on a real controller, too
  bool uhid = false;  ///< USB: HID devices without a host controller
  std::optional<double> duration_s{};
  double loss = 0, duplicate = 0;  ///< shares of frames or transfers, in each direction
  double runt = 0;                 ///< USB: share of the transfers that are cut
  double delay_s = 0, jitter_s = 0;
  double drift_ppm = 0;  ///< of the drives' clocks
  std::vector<std::string>
      faults{};  ///< "reset:left.x@2.5", seconds from the start; "-": on standard input
};

/// Until the duration, SIGINT or SIGTERM.
ExitCode run_emulate(const EmulateOptions& options, bool json);

}  // namespace hapticd::daemon
