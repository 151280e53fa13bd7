// May this process use a device node? Asked without opening it.
#pragma once
#include <optional>
#include <string>

#include "control/core/result.h"

namespace hapticd::usb {

/// Nothing: it may read and write the node.
std::optional<Error> access_problem(const std::string& node);
/// For one that could not be opened, with the errno of that.
Error open_problem(const std::string& node, int error);

}  // namespace hapticd::usb
