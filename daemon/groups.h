// The devices that share one inequality, as linear models.
#pragma once
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/design/check/certified.h"
#include "control/design/check/models.h"

namespace hapticd::daemon {

struct Group {
  check::Tied devices;
  check::TiedModel model;
  check::Matrix damping;  ///< N s/m over the model's coordinates, all of it; empty: none is known
  double latency_s = 0;
  bool linear = true;  ///< nothing but coupling and network acts on these devices
  std::string names;   ///< "left, right"
};

/// Those that a coupling or a network ties or holds; without jointed devices, whose damping depends
/// on the pose.
std::vector<Group> groups_of(const config::Compiled& compiled);

/// "left.x".
std::string coordinate_name(const config::Compiled& compiled, std::size_t coordinate);

}  // namespace hapticd::daemon
