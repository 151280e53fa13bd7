// `hapticctl devices`: which devices are there, and why a candidate cannot be used.
#pragma once
#include <string>
#include <vector>

#include "control/core/result.h"

namespace hapticd::daemon {

struct DevicesOptions {
  std::string interface {};        ///< this CAN interface alone; empty: all, and USB
  std::vector<std::string> ask{};  ///< drivers whose question is sent to every node
  double listen_s = 0.5;
};

/// `unavailable` where nothing can be used.
ExitCode run_devices(const DevicesOptions& options, bool json);

}  // namespace hapticd::daemon
