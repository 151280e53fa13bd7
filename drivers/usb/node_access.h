// May this process use a device node? Asked without opening it.
#pragma once
#include <optional>
#include <string>

#include "control/core/result.h"
#include "drivers/usb/host.h"

namespace hapticd::usb {

/// Nothing: it may read and write the node.
std::optional<Error> access_problem(const std::string& node);
/// For one that could not be opened, with the errno of that.
Error open_problem(const std::string& node, int error);
/// Of the device `what`. A node that was made a moment ago may yet get its rights from udev: it is waited for.
NotOpened not_opened(const std::string& what, const std::string& node, const Error& problem);

}  // namespace hapticd::usb
