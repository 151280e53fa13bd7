// How much force a pose may carry: 1 well inside the workspace, fading to 0 where the Jacobian gets
// singular. There a motor effort either cannot resist a direction of the tip, or becomes an unlimited
// force in it.
//
//   kappa = |J|_F |J^+|_F = sqrt(sum s_i^2 sum s_i^-2),  s_i the singular values (1 to 3 of them)
//   reach = 1 for kappa <= max / 2, 0 for kappa >= max, linear between
//
// kappa is n for an n x n Jacobian that is the same in all directions, and never less; for two
// directions it is c + 1/c with c the ratio of the singular values. A single coordinate or axis has
// kappa = 1 until J is 0.
#pragma once
#include "control/kinematics/kinematics.h"

namespace hapticd::control {

/// `jacobian`: at.coordinates x at.axes, row-major, all columns in one unit. 0 where not finite.
double reach_of(const Linkage& at, const double* jacobian) noexcept;

}  // namespace hapticd::control
