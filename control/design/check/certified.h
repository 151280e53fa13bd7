// Proofs that a certificate carries, checked on the compiled plan by Cholesky factorisations alone.
// Over the m coordinates that coupling and network name, with J_m their rows of the Jacobian and D_q
// what is left of the joints' damping beside direct rendering, compensation and observers (shares of
// one damping add up, since so do the inequalities of their forces), J_m' G J_m + D_q > 0 is
//
//   G + Delta > 0,   Delta = (J_m D_q^-1 J_m')^-1
//
// as v' Delta v is the least q'D_q q with J_m q = v.
//
//   passive_lmi, spring and damper   E + Phi_E passive by P_scene; N = K^-1 - (T/2) Delta^-1 > 0;
//     (a network that is not         Phi_E < (Delta^-1 + Delta_V^-1)^-1 with the exact level
//     passive by construction)       Delta_V = (T/2) N^-1 + N^-1 K^-1 B K^-1 N^-1; no latency
//   passive_lmi, general V(z)        V less (T/2) Delta^-1 (1 + theta + theta/z) (any latency up to
//                                    theta T, weights.h) has an inverse with the level Delta_V by
//                                    P_coupling; with Phi_E as above, then without latency
//   sampled_exact                    exact.h for F = (I + E V)^-1 E, at this latency held constant
//
// The first two need a scene that is passive beside the network (behind() in demand.h), or without
// latency weakly convex, whose level is added to Phi_E (weak_convexity.h); the last one
// that is linear: no bodies, no nonlinear fields, nothing rendered directly. It is void once the scene
// changes or a force reaches its limit.
#pragma once
#include "control/design/check/positive_real.h"
#include "control/design/check/tied_case.h"

namespace hapticd::check {

/// Delta for these m coordinates with `share` of the damping; empty: direct rendering, compensation
/// and observers leave nothing of it.
Matrix damping_left(const TiedCase& given, double share);

/// V less what latency takes: the system whose inverse P_coupling is about. Order n, with latency
/// n + m.
System yielding(const System& V, const Matrix& damping, double latency_s, double period_s);

struct Certified {
  Verdict verdict;
  Theorem theorem = Theorem::none;
};
/// Does the certificate prove these devices passive? `verdict.why` names what fails, by how much.
/// None of the devices is jointed.
Certified certified(const TiedCase& given, const Certificate& certificate);

}  // namespace hapticd::check
