// What the loop really runs for devices that a coupling or a network ties, as linear systems over
// the coordinates of their contacts (world axes), read back from the folded gains of the plan:
//
//   E  y -> force on the network          backward Euler, as control/coupling/group.h has it
//   V  force -> stretch d of the coupling, x = y + d
//   F  x -> force that the device has to bear, -f of group.h; F = (I + E V)^-1 E where all
//      coordinates are coupled
//
// Only what is linear: bodies, fields, rest lengths and the force limit are left out. With x held,
// y0 = reach (x - lag xi) - sway eta and f = -(pull y0 + swing eta) of group.h give, for springs and
// dampers (xi' = x - y0),
//
//   xi'  = (reach lag) xi + sway eta + (I - reach) x          I - reach: 0 where nothing is coupled
//   eta' = -(drive reach lag) xi + (sway_on - drive sway) eta + drive reach x
//   -f   = -(pull reach lag) xi + (swing - pull sway) eta + pull reach x
//
// and for a general V, xi' = recall xi - learn f.
#pragma once
#include <cstddef>
#include <vector>

#include "control/design/check/demand.h"
#include "control/design/check/linear.h"
#include "control/plan.h"

namespace hapticd::check {

struct TiedModel {
  /// Coordinates of the plan that coupling or network name, ascending: rows of all that follows.
  std::vector<std::size_t> coordinates;
  System F, E;
  bool all_coupled = false;    ///< every one has a coupling; else V, K, B below mean nothing
  bool spring_damper = false;  ///< V = (K + B sigma)^-1
  System V;
  Matrix K, B;                  ///< N/m, N s/m; where spring_damper
  bool passive_network = true;  ///< E is passive by construction (masses, springs, dampers >= 0)
};

/// No coordinates: neither a coupling nor a network ties or holds anything of these devices.
TiedModel tied_model(const control::Plan& plan, const Tied& devices);

}  // namespace hapticd::check
