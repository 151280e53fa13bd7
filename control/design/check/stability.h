// Is what the compiled plan renders passive on these devices, with every passive hand? One answer per
// device; devices that a coupling or a network ties have one together. With Delta_D the smallest
// damping of each axis in its uncertainty box, over the joints of those devices,
//
//   (T/2) Q + D < Delta_D,     Q = J' (K + sum_i k_i) J + travel,  D = J' (B + sum_i b_i) J + L
//
// K, B: the coupling. k_i, b_i: stiffness and damping of what is rendered directly, k n n' for a
// plane, k I for other bodies, the steepest slope of a field; objects behind a coupling ask nothing.
// travel: springs at its ends (both are one convex potential). L: the steepest slope of a friction
// compensation, and what a disturbance observer takes (observer_level.h). Objects that cannot be
// touched in the same tick are not added up.
//
// Theorem A: any scene that stands still, no latency, B >= 0. Proof. All proxies of the scene
// (control/scene/solve.h) are one vector p; J(p; x) is the energy of springs, bodies and fields, a
// function of x whose second derivative is at most Q; the force is -f, f = dJ/dx at the accepted p_k,
// and the descent check gives J(p_{k+1}; x_{k+1}) <= J(p_k; x_{k+1}). So with S_k = J(p_k; x_k) and
// d = x_{k+1} - x_k
//
//   f_k.d >= S_{k+1} - S_k - 1/2 |d|^2_Q                                                       (1)
//
// for any shape, friction, iteration cap or snap. A damper of the coupling, (B/T)(d_k - d_{k-1}),
// adds |.|^2_B / 2T to S and B/T to Q/2 (2 a'Bb >= -|a|^2_B - |b|^2_B). So does one of a wall that is
// rendered directly: e = how far the contact sank along the new normal in the last tick, force
// max(0, k p + (b/T) e):
//   in contact      (b/T) e n.d >= -(b/2T) (e^2 + (n.d)^2), beside (1) for the spring.
//   out of contact  f = 0, and what the next tick finds is at most (k/2 + b/2T) |d|^2.
//   clipped         k p < -(b/T) e. For n.d >= 0 the unclipped force would have been negative, so
//                   its work is even less than 0. For n.d < 0 the spring gains k p |n.d| +
//                   (k/2) |d|^2, and k p |n.d| <= (b/2T) (e^2 + |d|^2).
// A compensation of friction u = g(e/T) with |g'| <= L asks what a damper of L does.
// The force is held over the period, in which the device's damper takes at least d' Delta_D d / T of
// the energy (Cauchy-Schwarz), and a passive hand gives no more than it has. Held n times as long,
// both sides of the inequality but Delta_D grow n times.
//
// Theorem A': any scene that stands still, latency tau <= T, B = 0. s K < Delta_D,
//   s = (p + sqrt(p^2 + 2 t (T - t))) / 2, p = T/2 + 3 tau/2, with the loop's descent check sharpened
//   by g = tau/T + tau (T - tau) lambda / T, lambda the largest eigenvalue of Delta_D^-1 K.
//   Rendered directly, convex and without friction: s = (p + sqrt(p^2 + t (T - t))) / 2, p = T/2 + tau
//   (the force is a K-cocoercive map). t (T - t) is the largest that any latency up to tau has, so that
//   jitter below tau is covered. One axis, tau = 0: Colgate's k T/2 + b < b_device.
//
// Theorem B: passive scenes (bodies convex, friction or not; networks), latency tau <= T, B of any
//   sign: weights.h. Without latency and for B >= 0 also those that are weakly convex: magnets and
//   detents felt together with a network's masses: weak_convexity.h. As far as the solver is exact; where it ends early the record says so.
//
// Exact: this one linear scene; certified.h. Jointed devices: poses.h; under latency joint_space.cpp.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "control/design/check/certificate.h"
#include "control/plan.h"

namespace hapticd::check {

/// An object and why no proof covers it.
struct ObjectNote {
  std::string object;  ///< "box 'lid'"
  std::string reason;
};

/// What is assumed about a device, in plan order.
struct DeviceAssumption {
  std::string name;
  double latency_s = 0;
  bool latency_varies = false;           ///< up to that, from tick to tick
  std::vector<double> min_damping;       ///< N s/m or N m s/rad per axis; empty: no model given
  std::vector<std::string> obstacles{};  ///< why nothing can be proved for this device
  std::vector<ObjectNote> active{};      ///< objects it feels that give energy of their own
  std::vector<std::string> nonconvex{};  ///< those that are not convex, for people: "sphere 'ball'"
  bool heavy_network = false;            ///< a network that it touches has masses
};

enum class Theorem : std::uint8_t {
  none,
  any_static_scene,          ///< A: whatever stands still
  any_static_scene_latency,  ///< A': the same under latency
  passive_scene,  ///< B, Theorem 3 of the paper: bodies (weakly) convex, networks passive
  this_scene,     ///< exact: void once the scene changes
};
/// "A", "A'", "B", "exact"; "none".
const char* name_of(Theorem theorem) noexcept;

/// The answer for one device.
struct PassiveAnswer {
  bool proved = false;
  std::string why;  ///< the inequality with its figures, or what is missing
  double damping_used =
      0;  ///< share of the device's damping that the proof uses; < 1 where it is a proof
  double stiffness_factor =
      0;  ///< all stiffnesses may grow by this factor; infinity where there is none
  double longest_hold_s =
      0;  ///< a force may be held this long: the missed ticks that the proof tolerates; 0: not known
  Theorem theorem = Theorem::none;
  int missed_ticks = 0;                   ///< in a row, that the proof tolerates
  std::string worst_pose{};               ///< of jointed devices: where the contact is then
  std::vector<ObjectNote> uncertified{};  ///< objects that no proof covers
  std::vector<std::string> uncovered{};   ///< what no certificate covers
};

/// One answer per device. `assumed.size() == plan.devices.size()`. `certificate`: of the coupling
/// file; nullptr: closed forms only. Its `damping_share` bounds what closed forms may use, too.
std::vector<PassiveAnswer> passive(const control::Plan& plan,
                                   const std::vector<DeviceAssumption>& assumed,
                                   const Certificate* certificate = nullptr);

}  // namespace hapticd::check
