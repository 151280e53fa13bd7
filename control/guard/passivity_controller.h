// Time-domain passivity controller of one device: a gain r in [0, 1] on its contact force, so that
// the scene never gives out more energy than it has taken in, plus a budget. It never adds force,
// so nothing of its own can saturate.
//
//   E += -(work of the contact force) + credit * sum b q'^2 T - leak E     reserve [J], booked late by one tick
//   r  = min(r + rise, 1, max(0, E) / (S + ahead))
//   E  = min(E, r S + budget)
//
// S is what the springs that the contact touches would give back, `ahead` the work of the present
// force over the next few ticks. With E <= 0 the force is zero, so the energy that left never
// exceeds budget + credit + the work of one tick (plus the latency's).
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"
#include "control/core/findings.h"

namespace hapticd::control {

struct Plan;
struct State;

struct PassivityPlan {
  std::uint16_t device = 0;
  double budget = 0;  ///< J, > 0: reserve at the start and at most beyond the stored energy
  double credit = 0;  ///< share of the device's own damping that may be spent, in [0, 1)
  double leak = 0;    ///< share of the reserve that is forgotten in a tick
  double rise = 1;    ///< r grows by this per tick at most
};

struct PassivityState {
  double reserve = 0;  ///< J
  double gain = 1;
  double work = 0;  ///< J: of the contact force over the period that has just ended (book())
  double paid = 0;  ///< J: the device's own damping over the same period, times credit (book())
  bool started = false;
  /// Contact-force part of the delivered efforts, per axis of the device, by age in ticks.
  std::array<std::array<double, kMaxDelayTicks + 2>, kMaxAxesPerDevice> delivered{};
};

/// After the scene is rendered: reserve and gain of every device that has a controller. Sets
/// Limit::passivity where a gain is below 1.
void control_passivity(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
