// The sampled loop of one axis, exactly: a mass with a damper, held by a hand, and what a tick does.
//
// Between two changes of the command u the device is linear in continuous time,
//   M x'' + B x' + k x = u + push,   M = m + m_hand, B = b + b_hand, k = k_hand,
// and its state after any time is a matrix exponential. A tick samples (x, v), and sends
//   u_k = -contact F(x, v) - d_hat(x, u_{k-1}, h),
// which arrives at k T + tau, tau = n T + t, 0 <= t < T: u_{k-n-1} acts before and u_{k-n} after. With
// the state
//   z = (x, v, states of force and observer, u_{k-1}, .., u_{k-N}),  N > n,
// and Phi, Gamma of the device over some time,
//   (x, v)' = Phi(T) (x, v) + Phi(T - t) Gamma(t) u_{k-n-1} + Gamma(T - t) u_{k-n}.
// No approximation: any fraction t is allowed, and nothing is assumed about the order of the loop.
//
// `contact` is the share of the force that acts: 1 closed, 0 open. Open and without a hand's spring the
// device is free: it stays wherever it is, an eigenvalue 1 that is no instability. It is left out.
//
// The measured force of the hand (observers of mode `sensor`) is what passes from hand to device,
//   h = push - (m_hand x'' + b_hand v + k_hand x), just before the tick.
#pragma once
#include <optional>
#include <string>

#include "control/design/check/loop_parts.h"

namespace hapticd::check {

struct SampledLoop {
  System force;  ///< (x, v) -> N; direct_wall or rendered_scene
  std::optional<control::ObserverPlan> observer{};
  double period_s = 1e-3;
};

/// One of the loops that a loop may be. Hand: held rigidly; its spring goes to where it stands still.
struct LoopCase {
  double mass_kg = 0, damping_Ns_m = 0;
  double hand_kg = 0, hand_Ns_m = 0, hand_N_m = 0;
  double latency_s = 0;
  double contact = 1;
};

/// What is wrong with the loop or one of its cases; empty: nothing.
std::string malformed(const SampledLoop& loop, const LoopCase& one);

/// Ticks n that a command takes at least, and the fraction t of one that is left, s.
struct Latency {
  int ticks = 0;
  double fraction_s = 0;
};
Latency split_latency(double latency_s, double period_s);

/// What a tick does, each a row over (z, push).
struct Tick {
  Matrix before, after;  ///< commands that act before and after the new one arrives
  Matrix kept;           ///< z' but for x and v
};
/// `remembered` N > latency.ticks.
Tick tick_of(const SampledLoop& loop, const LoopCase& one, int remembered);

/// x' = A x + b u held for `time_s`: e^{A t} and what u adds.
struct Held {
  Eigen::Matrix2d phi;
  Eigen::Vector2d gamma;
};
Held held_device(const LoopCase& one, double time_s);

/// z' = A z, `remembered` at least 1 and more than the latency's whole ticks. Premises: well formed.
Matrix transition(const SampledLoop& loop, const LoopCase& one, int remembered);

/// Largest eigenvalue of the loop: it is stable iff it is below 1. NaN: malformed.
double loop_radius(const SampledLoop& loop, const LoopCase& one);

}  // namespace hapticd::check
