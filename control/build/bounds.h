// Boxes around the objects of a scene: what the broad phase sorts them by.
#pragma once
#include <optional>

#include "control/build/box_tree.h"
#include "control/build/program.h"

namespace hapticd::build {

/// Where the object of an encounter can act, over all of its path, without the tool's radius; none:
/// it has no bounds.
std::optional<Bounds> bounds_of(const ProgramSpec& spec, const control::Encounter& encounter);

}  // namespace hapticd::build
