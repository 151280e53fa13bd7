// What print.cpp says of one axis, a line for each thing that the config names.
#pragma once
#include <string>

#include "config/schema.h"
#include "control/plan.h"

namespace hapticd::config {

/// "163840 counts/m" and the like: six significant digits and a unit.
std::string with_unit(double value, const char* unit);

/// `along`: " along x", or nothing.
std::string axis_text(const control::Plan& plan, std::size_t index, const Axis& axis,
                      const std::string& along);

}  // namespace hapticd::config
