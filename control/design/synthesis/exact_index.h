// The paper's index J of a virtual wall (transmitted.h) for the sampled loop as it is:
//
//   J = integral over t >= 0 of (v_v - v_h)^2
//
// v_h: velocity of the device in the hybrid loop (sampled_loop.h), between the ticks too. v_v: of the
// wall that is meant, K x + B v, under the same push. The push is what w1 answers to an impulse at the
// first tick, w1 = 1/s: a step. A hand of mass, damper and spring is held by the device as by the
// wall:
//
//   m_hand x_v'' + (B + b_hand) x_v' + (K + k_hand) x_v = push,  v_v = x_v'.
//
// Between two changes of the command all of this is linear, y' = A y with y = (x, v, wall, weight, 1,
// u), and the integral of (c y)^2 over a time h is y' Q(h) y, where Phi = e^{A h} and
//
//   Q(h) = sum of h^(k+1)/(k+1)! L^k(c'c), L(Q) = A'Q + QA;   Q(2h) = Q(h) + Phi' Q(h) Phi.
//
// With F = s w1 the push is F's answer to the constant 1, so that every weight that the paper's block
// takes is one here. From tick to tick z' = M z + d for the rest of y; it comes to rest at r = (I -
// M)^-1 d, where both velocities are 0, from z = 0: J = r' X r, X = M' X M + Q over a period.
#pragma once
#include "control/design/check/sampled_loop.h"
#include "control/design/synthesis/rational.h"

namespace hapticd::synthesis {

using check::LoopCase;
using check::SampledLoop;

/// The wall that is meant, and the push it is judged by.
struct WallMeant {
  double stiffness_N_m = 0, damping_Ns_m = 0;
  Rational weight{Vector::Constant(1, 100.0), Eigen::Vector2d(100, 1)};  ///< w1
};

/// m^2/s. Infinity where the loop is unstable, or the integral has no end: a wall without damper or
/// hand's mass, and a push that jumps. NaN: malformed.
double exact_index(const SampledLoop& loop, const LoopCase& one, const WallMeant& meant);

}  // namespace hapticd::synthesis
