// Coupling and scene as text; part of config/print.h.
#pragma once
#include <string>

#include "config/compile.h"

namespace hapticd::config {

/// One line for each block of the coupling and each object of the scene.
std::string world_text(const Compiled& compiled);

/// Names of the devices that feel an object.
std::vector<std::string> felt_by(const Config& config, const Object& object);

}  // namespace hapticd::config
