// A network as an ordinary differential equation in the fewest states. For .cpp files only.
#pragma once
#include <Eigen/Dense>
#include <cstdint>
#include <vector>

#include "control/build/network.h"

namespace hapticd::build {

/// xi' = A xi + B y + drift,  f = C xi + D y + R'R y' - push;  y the contacts' coordinates [m], f
/// the force on the network [N]. R has as many rows as dampers that a contact feels at once.
struct NetworkModes {
  std::vector<std::uint32_t> coordinates;
  Eigen::MatrixXd A, B, C, D, R;
  Eigen::VectorXd drift, push;
  /// xi with all at rest: start_gain y + start_offset.
  Eigen::MatrixXd start_gain;
  Eigen::VectorXd start_offset;
};

/// `networks` are sound, each with a coordinate (separate()). The period only sets the scale by
/// which a damper counts as none.
NetworkModes network_modes(const std::vector<Network>& networks, double period_s);

}  // namespace hapticd::build
