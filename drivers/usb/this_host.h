// This machine with other places for sysfs and nodes, for tests.
#pragma once
#include "drivers/usb/host.h"
#include "drivers/usb/sysfs.h"

namespace hapticd::usb {

std::unique_ptr<Host> host_at(const Roots& roots);

}  // namespace hapticd::usb
