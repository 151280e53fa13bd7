// What is wrong with the options of a linkage.
#pragma once
#include <string>

#include "sim/options.h"

namespace hapticd::sim {

/// The first problem of options.linkage, empty if there is none. The axes and the hand are in order
/// on their own.
std::string linkage_problem(const DeviceOptions& options);

}  // namespace hapticd::sim
