// Whether a simulated device can be made as described.
#pragma once
#include <string>

#include "sim/options.h"

namespace hapticd::sim {

/// What is wrong first: what was expected and what was found. Empty: nothing.
std::string first_problem(const DeviceOptions& options);

}  // namespace hapticd::sim
