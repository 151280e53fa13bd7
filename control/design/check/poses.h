// Devices whose Jacobian depends on the pose. What is held over a period is the torque J' f, not f,
// so the condition stands in joint space, at every pose of the guarded workspace:
//
//   J' W J + (T/2) F_max |d2x/dq2| < D_q,     W = (T/2) K + B
//
// Derivation. With D = q_{k+1} - q_k and J = J(q_k) the force gives f'J D; along the straight line
// from q_k to q_{k+1} the contact moves by x_{k+1} - x_k = J D + r, |f'r| <= 1/2 F_max |d2x/dq2| D'D,
// and |x_{k+1} - x_k|^2_Q <= max over that line of D'J'QJ D (Jensen). Put into the sampled
// inequality of stability.h, which is about f'(x_{k+1} - x_k), that is the condition above on all
// such lines. A damper that is rendered directly, (b/T) n'J (q_k - q_{k-1}), is covered as well: its
// square counts once with J at either end of the line, b/2T each time.
//
// The guarded workspace: where no guard bites, that is, inside the workspace box and the travel
// limits of the plan, and well inside the singularity guard (reach = 1, control/kinematics/reach.h).
// Beyond it forces fade and are booked as limited. A line starts there and is no longer than the
// largest velocity allows.
//
// Branch and bound over boxes of poses proves the bound: at the middle of a box J is known, over all
// of it (and a step's length around it) second derivatives are bounded, by interval arithmetic or, on
// serial chains, by lengths of links. It is a proof, not a grid.
#pragma once
#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "control/plan.h"

namespace hapticd::check {

struct PoseDemand {
  Eigen::MatrixXd weight;    ///< W, N s/m, over the device's contact coordinates, >= 0
  double bending_force = 0;  ///< N, on the contact: F_max and the weight that motors hold
};

struct PoseAnswer {
  std::string problem;  ///< why nothing is known; empty: what follows holds
  double share = 0;     ///< at every pose the demand is at most this share of the damping
  double found = 0;     ///< springs and dampers alone need as much at `pose`: `share` is no less
  double bending = 0;   ///< the part of `share` that curvature asks, at most
  std::array<double, 3> pose{};  ///< contact coordinates [m]
  bool met = false;              ///< the guarded workspace has a pose at all (one was found)
};

/// Has this device a Jacobian that depends on the pose?
bool is_jointed(const control::Plan& plan, std::size_t device);

/// `damping`: per axis, N s/m or N m s/rad, > 0.
PoseAnswer largest_share(const control::Plan& plan, std::size_t device,
                         const Eigen::VectorXd& damping, const PoseDemand& demand);

}  // namespace hapticd::check
