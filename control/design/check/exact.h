// Exact sampled-data passivity of a known linear scene and coupling, with latency.
//
// F(z): sampled displacement x_k -> force f_k = F x that the scene puts on the device with a minus
// sign, held for a period T and late by tau = n T + t, 0 <= t <= T. Delta > 0: damping of the device.
//
// Over one period let w be the device's displacement, a of it before the new force arrives (which
// takes t) and b = w - a after. The old force does f_{k-n-1}.a of work, the new one f_{k-n}.b, and
// damping takes at least |a|^2_Delta / t + |b|^2_Delta / (T - t) (Cauchy-Schwarz, equality at constant
// speed). The least of the sum over all ways to split w, with e = f_{k-n} - f_{k-n-1}, is at
// a = (t/T) w + c, c = t (T - t) Delta^-1 e / (2 T):
//
//   [(1 - t/T) f_{k-n} + (t/T) f_{k-n-1}].w + |w|^2_Delta / T - (eta T/4) |e|^2 in Delta^-1,
//   eta = t (T - t) / T^2.                                                                         (1)
//
// Any sequence of w is a motion, so device and controller together are passive at the hand iff sums
// of (1) are bounded below, for all w from rest: iff, with f = T z^-n F/(z-1) (from w/T to f_{k-n}),
// q = (1 - 1/z) f, on the whole unit circle
//
//   Delta + He[f - (t/T) q] - (eta/4) q^H Delta^-1 q >= 0,                                         (2)
//
// F is stable and F(1) is symmetric >= 0. For t = 0 (2) says that Delta + T F/(z-1) is positive real:
// the condition of Colgate and Schenkel (1997) in matrices.
//
// The pole at z = 1 in closed form: z^-n F = (A, B, C, D), F1 = F(1), x = (I - A)^-1 B:
//   f = T F1/(z-1) + C (z I - A)^-1 (-T x),   He 1/(z-1) = -1/2 on the circle,
//   q = T F1/z + (1 - 1/z) C (z I - A)^-1 (-T x).
// State xi of that, p = T F1 sum of w/T, phi = f_{k-n-1} - p:
//   xi' = A xi - T x u,  phi' = C xi - T F1 u,  e = C xi - phi,  f_{k-n} = p + C xi,  u = w/T
// and p's own storage |p|^2 / 2T in F1^-1 takes (T/2) |u|^2_F1. So (1) / T is a dissipation inequality
// (dissipation.h) with
//   A2 = [A 0; C 0],  B2 = [-T x; -T F1],  S = 1/2 [(1 - t/T) C, (t/T) I],
//   R = Delta - (T/2) F1,  |Y|^2 = (eta/4) |[C, -I]|^2 in Delta^-1.
// A P for it proves passivity, stability of F included; with tau = 0 without phi.
#pragma once
#include "control/design/check/positive_real.h"

namespace hapticd::check {

/// Least eigenvalue of (2) over all frequencies, N s/m, by a sweep: how much damping could be missing
/// on all axes (exactly so without latency). Negative: not passive. -infinity: F has a pole on or
/// outside the unit circle, or F(1) is not symmetric >= 0. NaN: malformed.
double exact_margin(const System& f, const Matrix& damping, double latency_s, double period_s);

/// The finite proof. P is of order states + m ceil(latency / period): the states of F, forces 1, 2,
/// .. samples old. It holds for this F and no other.
Verdict proves_exact(const System& f, const Matrix& damping, double latency_s, double period_s,
                     const Matrix& P);
Premises exact_premises(const System& f, const Matrix& damping, double latency_s, double period_s);

/// Left hand side of (2) at one frequency from the value of F there, F(1) >= 0 given: for searches
/// that change F but not the frequencies. `angle` in (0, pi].
ComplexMatrix exact_condition(const ComplexMatrix& f, const Matrix& damping, double latency_s,
                              double period_s, double angle);

}  // namespace hapticd::check
