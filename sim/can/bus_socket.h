// A SocketCAN interface for emulated drives: all that is on it, classic and FD.
#pragma once
#include <string>

#include "control/core/result.h"

namespace hapticd::sim::can {

/// A non-blocking raw socket; the caller closes it. Errors: no CAN in the kernel, no such interface.
Result<int> open_bus(const std::string& interface);

}  // namespace hapticd::sim::can
