// The plane of a scene that has one, for verbs that look at a single wall.
#pragma once
#include <algorithm>
#include <variant>

#include "config/schema.h"

namespace hapticd::daemon {

/// The first plane of the scene. Premise: there is one.
inline config::Plane& wall_of(config::Config& config) {
  return std::get<config::Plane>(*std::ranges::find_if(config.scene, [](const auto& object) {
    return std::holds_alternative<config::Plane>(object);
  }));
}

}  // namespace hapticd::daemon
