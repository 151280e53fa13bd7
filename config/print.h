// A compiled config as text, for hapticctl check.
#pragma once
#include <string>

#include "config/compile.h"

namespace hapticd::config {

/// For people: devices, axes, limits in SI, scene, rate, what is assumed, where files go.
std::string describe_plan(const Compiled& compiled);
/// The same for machines: one JSON object, without a line feed at its end.
std::string plan_json(const Compiled& compiled);

}  // namespace hapticd::config
