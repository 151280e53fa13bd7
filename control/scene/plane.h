// A half-space felt by one contact: spring and damper that push out of the wall and never pull.
//
//   depth p = offset - n.x,  force on the contact  f = n max(0, k p - b n.v)  while p > 0, else 0
//
// n unit normal towards the free side (projected on the contact's coordinates), v the velocity that
// the axes report. With v the backward difference this is passive at zero latency with any passive
// hand if k T/2 + b is below the device's damping (proof: control/design/check/stability.h).
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"

namespace hapticd::control {

struct PlaneContact {
  std::uint16_t first_coordinate = 0;
  std::uint16_t coordinates = 0;
  std::array<double, kMaxContactCoordinates> normal{};  ///< per coordinate of the contact
  double offset = 0;                                    ///< m: n.x on the surface
  double stiffness = 0;                                 ///< N/m, >= 0
  double damping = 0;                                   ///< N s/m, >= 0
};

/// Energy [J] in the plane's spring with the contact at `x` [m].
double stored_energy(const PlaneContact& plane, const double* x) noexcept;

/// Adds the plane's force [N] on a contact at `x` [m] with velocity `v` [m/s]; all are
/// `plane.coordinates` long.
void add_force(const PlaneContact& plane, const double* x, const double* v, double* force) noexcept;

}  // namespace hapticd::control
