// Spring-damper couplings in closed form. V(z) = [K + B (1 - 1/z)/T]^-1 (Bianchini, Orlandesi, Prattichizzo
// 2010, (20)), K, B symmetric, K > 0, Delta the device's damping > 0, a = K T/2.
//
// N = K T + B gives K + B (1 - 1/z)/T = (1/T)(I - A_V/z) N with A_V = B N^-1, so V = T N^-1
// (I - A_V/z)^-1: states A_V, T A_V, output N^-1, T N^-1, their (21), (22).
//
// On the circle, He V^-1 = K + B (1 - cos)/T, |V^-1|^2 in one axis = K^2 + 2 B (K + B/T)(1 - cos)/T,
// and the loop transformation with kappa = (T/2) Delta^-1 turns V into V^ = sigma (V - kappa),
// sigma = (1 - 1/z)/T. From these:
//
// * A passive scene is safe iff a + B < Delta (B >= 0): He sigma V = Re sigma T (a + B) /
//   [(a+B)^2 (1-u) + a^2 (1+u)] in one axis, u = cos w T, against He sigma kappa = Re sigma T / (2
//   Delta): least at u = -1, where it is a + B <= Delta. Matrices: the same with X = a + B, since
//   2 B - B X^-1 B >= 0.
// * The level: V^ passes u'y >= |y|^2 in Delta_V iff He V^^-1 >= Delta_V. V - kappa = (V^-1)^-1 -
//   kappa; with N' = K^-1 - (T/2) Delta^-1 (at rest V - kappa = N') the smallest Hermitian part is
//   at rest: Delta_V = (T/2) N'^-1 + N'^-1 K^-1 B K^-1 N'^-1 (from the slope of V at z = 1; in one
//   axis p = 1 - a/Delta: K T/(2 p) + B/p^2). Checked against sweeps.
// * A scene that needs the level Phi >= 0 is safe iff Phi < (Delta^-1 + Delta_V^-1)^-1, the (10) of
//   the paper with Phi I >= 0; B = 0: iff (2/T) Phi < K < (2/T) Delta.
#pragma once
#include "control/design/check/dissipation.h"

namespace hapticd::check {

/// V(z), displacement over force: m/N. K T + B must be regular.
System spring_damper(const Matrix& stiffness, const Matrix& damper, double period_s);

/// Share of the damping that K T/2 + B uses: its largest eigenvalue over Delta. Passive scenes of any
/// kind are safe with a coupling of B >= 0 iff it is < 1. NaN: Delta is not > 0.
double damping_share(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                     double period_s);

/// Delta_V; empty where there is none: K > 0, B >= 0 and K T/2 + B < Delta are required.
Matrix output_level(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                    double period_s);
/// One axis, B < 0 too. NaN: none.
double output_level(double stiffness, double damper, double damping, double period_s);

/// (Delta^-1 + Delta_V^-1)^-1: a scene with the level Phi is safe iff Phi is below this. Empty as
/// output_level.
Matrix tolerated_level(const Matrix& stiffness, const Matrix& damper, const Matrix& damping,
                       double period_s);

/// The stiffness that a spring may have with a scene that needs `phi` >= 0, one axis, B = 0, N/m;
/// low >= high: none.
struct StiffnessRange {
  double low = 0, high = 0;
};
StiffnessRange spring_range(double phi, double damping, double period_s);

}  // namespace hapticd::check
