// Disturbance observer of one axis or one contact coordinate, in the three modes that do something
// (Eom, Suh, Yi; design of the modes in control/observer/README.md).
//
//   r_k  = m (x_k - 2 x_{k-1} + x_{k-2}) / T^2 + b (x_k - x_{k-1}) / T
//          - (u_{k-1-n} + u_{k-2-n}) / 2 - (h_{k-1} + h_{k-2}) / 2
//   s1  += a (r - s1),  s2 += a2 (s1 - s2),  d_hat = s2;  the observer adds -d_hat
//
// u is what the device really delivered for the command (compensations taken out: they belong to
// the plant), h the hand's force where a sensor measures it. The mean of two commands is the
// sampling zero of a held double integrator, so for m = mass and b = 0 the residual is exactly the
// disturbance.
//
//   mode      m            b            u    h
//   classic   m_n          b_n          yes  no    rejects everything, the hand included
//   sensor    m_n          b_n          yes  yes   rejects everything but the measured hand
//   model     m_n - mass   b_n - damp.  no   no    makes the axis feel like m_n, b_n; gain 1 in the
//                                                  command path
//
// Order 1 is a2 = 1. After missed ticks or samples the history of positions starts anew and d_hat
// is kept until three are known: a second difference over a gap would be a spike.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"
#include "control/core/motion.h"

namespace hapticd::control {

struct ObserverPlan {
  std::uint16_t source = 0;  ///< axis, or contact coordinate
  std::uint16_t device = 0;
  double inertia = 0;             ///< kg or kg m^2, over T^2: N per m or N m per rad
  double damping = 0;             ///< N s/m or N m s/rad, over T: N per m or N m per rad
  double command_share = 0;       ///< 1: classic, sensor; 0: model
  double hand_share = 0;          ///< 1: sensor
  double share = 0;               ///< a = 1 - exp(-2 pi f_c T)
  double second_share = 0;        ///< a of the second lag; 1: order 1
  double max_output = 0;          ///< N or N m
  double blend_per_tick = 1;      ///< the output fades in from a cold start by this share a tick
  std::uint16_t extra_delay = 0;  ///< n, whole ticks, at most kMaxDelayTicks
};

struct ObserverState {
  double x1 = 0, x2 = 0;  ///< positions of one and two ticks ago
  double s1 = 0, s2 = 0;
  double residual = 0;                               ///< r
  double blend = 0;                                  ///< 0 to 1
  std::uint16_t known = 0;                           ///< positions without a gap, up to 2
  std::array<double, kMaxDelayTicks + 2> command{};  ///< u_{k-1}, u_{k-2}, ...
  std::array<double, 2> hand{};                      ///< h_{k-1}, h_{k-2}
};

/// One tick of one observer: `x` now, `command` delivered over the period that ended, `hand` now.
/// Returns the effort to add, within max_output, blended.
double observe(const ObserverPlan& plan, ObserverState& state, Motion motion, double x,
               double command, double hand) noexcept;

}  // namespace hapticd::control
