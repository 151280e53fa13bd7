// What springs and dampers ask of a device's damping under latency tau <= T, any latency up to tau,
// also one that changes from tick to tick.
//
// Springs alone (Theorem A' and its sibling for direct rendering): s K < Delta, see stability.h.
//
// Springs and dampers in front of a passive scene (Theorem B), X = K + 2 B/T > 0, u = cos wT:
//
//   T/4 (1 + 2 theta (1 + u)) [(1 + u) K X^-1 K + (1 - u) X] < Delta    for all u in [-1, 1]
//
// theta = tau/T. Derivation. The force is f_{k-1} for tau and f_k for the rest of the period; with e_k =
// f_k - f_{k-1} and the device's damper spending a'Delta a/tau + b'Delta b/(T - tau) on the two parts
// of a period's motion w_k, the energy that the loop takes up in it is at least
//
//   f_{k+1}.w_k - q.w_k + w'Delta w/T - (T/4) theta (1 - theta) |e_k|^2,   q = e_{k+1} + theta e_k
//   >= f_{k+1}.w_k - (T/4) [|e_{k+1}|^2 + theta (2 e_{k+1}.e_k + |e_k|^2)],         norms by Delta^-1
//
// and for any theta_k in [0, theta] the bracket is at most |e_{k+1}|^2 + theta |e_{k+1} + e_k|^2, in
// frequency |e|^2 (1 + 2 theta (1 + u)). A constant latency gives 1 + theta (1 + 2u) instead, what the
// paper's constant (T/2) Delta^-1 becomes with tau. A scene that is passive, f.dy >= dS, with x = y +
// V f leaves sum f.d(V f), d the backward difference. With c = 1 - 1/z, |c|^2 = 2 (1 - u) and W = V^-1
// = K + B c/T: Re(c V) = (|c|^2/2) V^H X V, so all of it is positive if X >= (T/2) (...) W^H Delta^-1 W,
// which turns around to Delta >= (T/2) (...) W X^-1 W^H; and with W = K (1 - c/2) + X c/2 the mixed
// terms, Re c - |c|^2/2, vanish: W X^-1 W^H = K X^-1 K (1 + u)/2 + X (1 - u)/2.
// One axis, constant latency: the closed form of spring_damper.h.
#pragma once
#include <Eigen/Core>
#include <vector>

namespace hapticd::check {

/// s [s] of a spring that is rendered directly, convex and without friction.
double direct_weight(double latency_s, double period_s);
/// s [s] of a spring of the coupling (Theorem A').
double coupled_weight(double latency_s, double period_s);
/// Theorem A' asks the loop's descent check for this g; `rate` = lambda_max(Delta^-1 K) [1/s].
double sharpness(double latency_s, double period_s, double rate);

/// Matrices [N s/m] each of which has to be less than Delta: then the inequality of Theorem B holds
/// for every u. They are the Bernstein coefficients of that quadratic in u on short intervals, so no
/// u is left out; what they ask too much falls with the square of the length (1/2 % at most). Empty:
/// X is not > 0, nothing holds.
std::vector<Eigen::MatrixXd> passive_scene_demands(const Eigen::MatrixXd& K,
                                                   const Eigen::MatrixXd& B, double latency_s,
                                                   double period_s);

}  // namespace hapticd::check
