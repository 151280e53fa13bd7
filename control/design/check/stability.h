// Is the compiled scene passive on these devices? The one proof known so far is the closed form for
// planes rendered directly, at zero latency, on devices whose Jacobian is constant; per device the
// matrix inequality
//
//   (T/2) sum_i k_i n_i n_i'  +  sum_i b_i n_i n_i'  +  sum_j ((T/2) k_j + L_j) e_j e_j'  <  Delta_D
//
// with Delta_D the diagonal of the smallest damping of each axis in its uncertainty box, n_i the
// plane's normal in joint coordinates, J' n; k_j the stiffness of the springs at the ends of the
// travel of axis j (both ends are one convex potential with second derivative up to k_j), and L_j
// the steepest slope of its friction compensation. For one axis and one plane it is Colgate's
// k T/2 + b < b_device. Every plane is summed as if all were touched at once.
//
// Proof. For one plane let p_k be the depth, e = p_k - p_{k-1}, d = p_{k+1} - p_k, P = max(p, 0);
// the force is f = max(0, k p + (b/T) e) where p > 0, else 0. With the storage
// S_k = (k/2) P_k^2 + (b/2T) e^2 the inequality
//
//   f d >= S_{k+1} - S_k - (k/2 + b/T) d^2                                                     (1)
//
// holds in each of the three cases:
//   in contact      k p d >= (k/2) (P_{k+1}^2 - P_k^2 - d^2) and (b/T) e d >= -(b/2T) (e^2 + d^2);
//                   their sum is (1).
//   out of contact  f = 0 and P_{k+1} <= max(0, d), so the right side of (1) is at most
//                   (k/2) d^2 + (b/2T) d^2 - (k/2 + b/T) d^2 <= 0.
//   clipped         p > 0 but k p + (b/T) e < 0, so f = 0. For d >= 0 the unclipped force times d
//                   is negative and, by the first case, no less than the right side. For d < 0 P
//                   does not grow, and (b/2T) (d^2 - e^2) <= (b/T) d^2.
// A compensation of friction u = g(e/T) with |g'| <= L gives |u d| <= (L/T) |e| |d|, at most
// (L/2T) (e^2 + d^2): with the storage (L/2T) e^2 it asks (L/T) d^2, as a damper of L does.
//
// The force is held over the period, in which the device's damper takes at least d' Delta_D d / T of
// the energy (Cauchy-Schwarz), and a passive hand gives no more than it has. The sum of (1) over the
// planes is paid for if the matrix inequality holds; forces of several planes and devices add.
#pragma once
#include <string>
#include <vector>

#include "control/plan.h"

namespace hapticd::check {

/// What is assumed about a device, in plan order.
struct DeviceAssumption {
  std::string name;
  double latency_s = 0;
  std::vector<double> min_damping;       ///< N s/m or N m s/rad per axis; empty: no model given
  std::vector<std::string> obstacles{};  ///< why the closed form does not hold for this device
};

/// The answer for one device.
struct PassiveAnswer {
  bool proved = false;
  std::string why;  ///< the inequality with its figures, or what is missing
  double damping_used =
      0;  ///< share of the device's damping that the proof uses; < 1 where it is a proof
  double stiffness_factor =
      0;  ///< all stiffnesses may grow by this factor; infinity where there is none
  double longest_hold_s =
      0;  ///< a force may be held this long: the missed ticks that the proof tolerates
};

/// One answer per device. `assumed.size() == plan.devices.size()`.
std::vector<PassiveAnswer> passive(const control::Plan& plan,
                                   const std::vector<DeviceAssumption>& assumed);

}  // namespace hapticd::check
