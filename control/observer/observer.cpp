#include "control/observer/observer.h"

#include <algorithm>
#include <cmath>

namespace hapticd::control {
namespace {

// No force of this world [N or N m]: a residual beyond it comes from an input that is not a number,
// or as good as none. It is treated as a gap, so the lags stay finite for ever.
constexpr double kAbsurd = 1e9;

/// Positions start anew at x. Before anything was integrated the device is taken to be at rest, so
/// that the first period counts.
void restart_positions(ObserverState& state, double x) noexcept {
  const bool cold = state.blend == 0;
  state.x1 = state.x2 = x;
  state.known = cold ? 2 : 1;
}

/// What happened over the period that ended: it is known now, whatever the positions are worth.
/// Only the ages that the plan asks for are kept.
void remember_command(const ObserverPlan& plan, ObserverState& state, double command) noexcept {
  for (std::size_t age = plan.extra_delay + 1u; age > 0; --age)
    state.command[age] = state.command[age - 1];
  state.command[0] = command;
}

double residual_of(const ObserverPlan& plan, const ObserverState& state, double x) noexcept {
  const double commands = state.command[plan.extra_delay] + state.command[plan.extra_delay + 1u];
  const double hands = state.hand[0] + state.hand[1];
  const double step = x - state.x1;
  const double motion = plan.inertia * (step - (state.x1 - state.x2)) + plan.damping * step;
  return motion - 0.5 * (plan.command_share * commands + plan.hand_share * hands);
}

void integrate_lags(const ObserverPlan& plan, ObserverState& state) noexcept {
  state.s1 += plan.share * (state.residual - state.s1);
  state.s2 = state.s1 + (1 - plan.second_share) * (state.s2 - state.s1);  // order 1: s1 itself
  state.blend = std::min(1.0, state.blend + plan.blend_per_tick);
}

/// A tick over a gap, or with too few positions behind it.
[[gnu::cold]] void advance_unusual(ObserverState& state, Motion motion, double x,
                                   bool absurd) noexcept {
  if (motion != Motion::advanced || absurd) {
    restart_positions(state, x);
    return;
  }
  ++state.known;
  state.x2 = state.x1;
  state.x1 = x;
}

void advance(const ObserverPlan& plan, ObserverState& state, Motion motion, double x) noexcept {
  const double r = residual_of(plan, state, x);
  const bool sane = std::abs(r) < kAbsurd;
  if (motion != Motion::advanced || state.known != 2 || !sane) {
    advance_unusual(state, motion, x, !sane);
    return;
  }
  state.residual = r;
  integrate_lags(plan, state);
  state.x2 = state.x1;
  state.x1 = x;
}

}  // namespace

double observe(const ObserverPlan& plan, ObserverState& state, Motion motion, double x,
               double command, double hand) noexcept {
  remember_command(plan, state, command);
  advance(plan, state, motion, x);
  state.hand[1] = state.hand[0];
  state.hand[0] = hand;
  const double output = -state.blend * state.s2;
  return std::min(std::max(output, -plan.max_output), plan.max_output);
}

}  // namespace hapticd::control
