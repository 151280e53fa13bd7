// Devices of a compiled config, by driver. A new driver is named here and nowhere else in the
// daemon.
#pragma once
#include <memory>
#include <vector>

#include "config/compile.h"
#include "drivers/device.h"

namespace hapticd::daemon {

/// In plan order; not yet connected.
std::vector<std::unique_ptr<drivers::Device>> make_devices(const config::Compiled& compiled);

}  // namespace hapticd::daemon
