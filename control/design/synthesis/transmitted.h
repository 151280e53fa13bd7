// A virtual wall on one axis as Eom, Suh and Yi design it, in continuous time: what the paper says of
// a wall's damper B_c, with all that it leaves open as options. Whether the sampled loop agrees is
// for sampled_loop.h to say; the paper's conditions are neither necessary nor sufficient for it.
//
//   P = 1/(m s + b)                       device
//   Y_v = s/(K + B s)                     admittance of the wall that is meant (the paper's (8) is its
//                                         inverse)
//   C = B_c + K/s                         controller; K is the wall's, or the error at rest is not 0
//   Y_t = P/(1 + ZOH P C)                 admittance that is transmitted                            (9)
//   J = |w1 (Y_v - Y_t)|_2^2                                                                       (11)
//   m (1 + alpha Delta), b (1 + beta Delta), |Delta| <= 1: W = alpha m s + beta b             (13)-(15)
//   L = -W Y_t                                                                                     (16)
//   |L|_inf <= 1                                                                                   (17)
//
// (17) says nothing of a nominal loop that is unstable: |L| on the imaginary axis comes below 1 again
// for a large B_c where it is. So stability is decided apart: by the zeros of
//   d(s) = s (m s + b) + ZOH (B_c s + K),
// or, where ZOH is not rational, by Mikhailov's criterion, d(jw) turning by pi from w = 0 to infinity.
// "Stable for every such Delta" follows from (17); it is not necessary, because Delta is real.
//
// J. Y_v = s X_v and Y_t = s X_t with the compliances X_v = 1/(K + B s), X_t = 1/d, so that one pole of
// w1 at s = 0 is cancelled in F = s w1: the step response is w1 = 1/s. With
//   E = F (X_v - X_t),  dE/dB_c = F s ZOH X_t^2
// J = |E|^2 and dJ/dB_c = 2 <E, dE/dB_c> come from one Lyapunov equation where ZOH is rational, else
// from an integral over frequency. The minimum is where dJ/dB_c changes sign: J is too flat there for
// its values to tell where. Without a hold and with w1 = 1/s, c = b + B_c,
//   J = 1/(2 B K) + 1/(2 c K) - (2/B)/(m (K/B)^2 + c K/B + K),  minimal at B_c = B + m K/B - b.
#pragma once
#include <string>

#include "control/design/synthesis/hold_model.h"

namespace hapticd::synthesis {

struct WallGoal {
  double mass_kg = 0;
  double damping_Ns_m = 0;
  double mass_uncertainty = 0;     ///< alpha
  double damping_uncertainty = 0;  ///< beta
  double stiffness_N_m = 0;        ///< K
  double wall_damping_Ns_m = 0;    ///< B
  double period_s = 1e-3;
  HoldModel hold;
  Rational weight{Vector::Constant(1, 100.0), Eigen::Vector2d(100, 1)};  ///< w1
};
/// What is wrong with it; empty: nothing.
std::string malformed(const WallGoal& goal);

Complex transmitted_admittance(const WallGoal& goal, double damper_Ns_m, Complex s);
bool nominally_stable(const WallGoal& goal, double damper_Ns_m);

struct TransparencyIndex {
  double value = 0;  ///< J; infinity where the loop is unstable or the integral has no end
  double slope = 0;  ///< dJ/dB_c
};
TransparencyIndex transparency_index(const WallGoal& goal, double damper_Ns_m);

/// |L|_inf, as a number: the largest |L(jw)|, whether the loop is stable or not.
double perturbation_norm(const WallGoal& goal, double damper_Ns_m);

/// What the paper would print for one B_c.
struct PaperAnswer {
  double index = 0;
  double norm = 0;
  bool stable = false;  ///< nominally
  bool robust = false;  ///< stable, and norm <= 1
};
PaperAnswer paper_answer(const WallGoal& goal, double damper_Ns_m);

}  // namespace hapticd::synthesis
