// Time-domain passivity controller of one device: a gain r in [0, 1] on its contact force, so that
// the scene never gives out more energy than it has taken in, plus a budget. It never adds force,
// so there is no limit of its own that could make it fail.
//
//   E += credit * (what the device's own damping took) - (work of the contact force) - leak E
//   r  = min(r + rise, 1, E / max(S, ahead)),  0 if E <= 0
//   E  = min(E, r S + budget)
//
// E is the reserve [J], booked a tick after the force; S what the springs that the contact touches
// would give back, `ahead` what the present force does in the next few ticks at the present speed,
// so that a scene without springs is faded and not chopped. With E <= 0 there is no force, so the
// net energy that ever leaves is at most the budget and the work of one tick (with latency: of the
// ticks until a force has ended).
//
// credit < 1 and the cap on E are essential: with neither, limit cycles live on what the damping
// has paid before (observed for a rigid wall; same scheme as the energy-bounding and reserve
// variants of Hannaford and Ryu's passivity controller, 2002).
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"
#include "control/core/findings.h"
#include "control/guard/ledger.h"

namespace hapticd::control {

struct Plan;
struct State;

struct PassivityPlan {
  std::uint16_t device = 0;
  double budget = 0;  ///< J, > 0: reserve at the start, and at most beyond the stored energy
  double credit = 0;  ///< share of the device's own damping that may be spent, in [0, 1)
  double leak = 0;    ///< share of the reserve that is forgotten in a tick, in [0, 1)
  double rise = 1;    ///< r grows by this per tick at most, > 0
};

struct PassivityState {
  double reserve = 0;  ///< J
  double gain = 1;
  bool running = false;  ///< under force in the last tick: reserve and gain go on
  double work = 0;       ///< J: of the contact force since the last fresh sample (book())
  double damped = 0;     ///< J: that the device's own damping took meanwhile (book())
  std::array<HeldEffort, kMaxAxesPerDevice> effort{};  ///< contact-force part, per axis
};

/// Weakens state.force of the devices that have a controller; records state.reserve and state.gain.
/// Sets Limit::passivity where a gain is below 1. Outside Mode::enabled every controller starts
/// anew.
void control_passivity(const Plan& plan, State& state, Findings& findings) noexcept;

}  // namespace hapticd::control
