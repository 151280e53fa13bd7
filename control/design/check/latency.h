// What latency asks of the damping, for any scene of a class (a known linear one: exact.h).
// Latency tau = n T + t, 0 <= t < T; Delta > 0 the device's damping; sigma = (1 - 1/z)/T.
//
// Springs, exactly. A spring K between device and ground is F = K in exact.h's condition:
// b > (K/2) [ (T/2 + tau) + sqrt((T/2 + tau)^2 + t (T - t)) ]. It is also enough for any memoryless
// convex scene. For whole periods it is K (T/2 + tau); between them that would be too little.
//
// Passive scenes of any kind (springs, dampers, masses, convex bodies, friction). With
// e = x - x_k the motion since the sample that the force in force belongs to, the work of the held,
// late force differs from that of the sampled one by a term that the device's damping must pay for:
//
//   kappa(z) = (T/2) Delta^-1 (1 + z^-1 + .. + z^-n + (t/T) z^-(n+1))
//
// stands in the place of the paper's constant (T/2) Delta^-1, and the loop is passive at the hand for
// every passive scene iff sigma (V - kappa) is positive real. This is linear in V. On the circle
// sigma (z - 1) = -2 (1 - cos)/T is real, so with X = V - kappa = (A, B, C, D), x = (I - A)^-1 B,
// X1 = X(1):  X = X1 - (z - 1) C (z I - A)^-1 x  gives
//
//   He sigma X = Re sigma (He X1 + 2 He C (z I - A)^-1 x)                                          (1)
//
// and Re sigma >= 0: the zero of sigma at z = 1 is gone, and (1) is an ordinary positive real
// condition, which a P of the order of X proves. (X1 must be symmetric: its skew part would be
// multiplied by the imaginary part of sigma, which is of lower order.)
//
// One axis, V a spring-damper, a = K T/2, u = cos w T: sigma V is Re sigma T (a + B) / [(a+B)^2 (1-u) +
// a^2 (1+u)] (spring_damper.h), Re sigma z^-1 = Re sigma (1 + 2 u), so for tau <= T
//
//   Delta > max over u in [-1, 1] of [(T - tau) + 2 tau (1 + u)] [(a+B)^2 (1-u) + a^2 (1+u)] / (2 T (a+B)),
//
// a quadratic in u. B = 0: Delta > K (T + 3 tau)/2, at u = 1.
#pragma once
#include "control/design/check/positive_real.h"

namespace hapticd::check {

/// Damping that a spring needs with latency, N s/m; exact.
double spring_needs_damping(double stiffness, double latency_s, double period_s);

/// Damping that a spring-damper needs with latency <= T so that every passive scene is safe.
/// K > 0, B > -K T/2; NaN elsewhere.
double passive_scene_needs_damping(double stiffness, double damper, double latency_s,
                                   double period_s);

/// kappa(z), m/N.
System latency_compliance(const Matrix& damping, double latency_s, double period_s);

/// Smallest eigenvalue of He sigma (V - kappa) / Re sigma over all frequencies, m/N, by a sweep: >= 0
/// iff passive scenes are safe. -infinity: V is not stable, or V(1) not symmetric. NaN: malformed.
double passive_scene_margin(const System& v, const Matrix& damping, double latency_s,
                            double period_s);
/// The finite proof; P of the order of V plus m (n + 1), or of V's order without latency.
Verdict proves_passive_scenes(const System& v, const Matrix& damping, double latency_s,
                              double period_s, const Matrix& P);
Premises passive_scene_premises(const System& v, const Matrix& damping, double latency_s,
                                double period_s);

}  // namespace hapticd::check
