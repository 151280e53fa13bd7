// Devices on USB as text; part of config/print.h.
#pragma once
#include <string>

#include "config/compile.h"

namespace hapticd::config {

/// Of a device: which one is meant, its times, the latency that it needs; empty: it is not on USB.
std::string usb_text(const Compiled& compiled, std::size_t device);

}  // namespace hapticd::config
