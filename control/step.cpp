#include "control/step.h"

#include <algorithm>

#include "control/guard/actuate.h"
#include "control/guard/bound.h"
#include "control/guard/guard.h"
#include "control/guard/ledger.h"
#include "control/guard/mode.h"
#include "control/kinematics/kinematics.h"
#include "control/motion/sense.h"
#include "control/observer/compensation.h"
#include "control/scene/carry.h"
#include "control/scene/render.h"

namespace hapticd::control {

TickOutput step(const Plan& plan, State& state,
                const TickInput& input) noexcept HAPTICD_NONBLOCKING {
  Findings findings;
  sense(plan, state, input, findings);
  book(plan, state, input);
  forward(plan, state, findings);
  bound(plan, state, findings);
  compensate(plan, state, input, findings);
  render(plan, state, input, findings);
  decide_mode(plan, state, input, findings);
  guard(plan, state, findings);
  actuate(plan, state, findings);
  return {
      .effort = state.effort, .mode = state.mode, .limits = findings.limits, .fault = state.fault};
}

namespace {

/// Entries of one kind: those of the new plan whose axis (or coordinate) the old one has too go on
/// from its state. `key` says what two entries must share.
template <class Entry, class Kept, class Key>
void carry(std::span<const Entry> from_plans, std::span<Kept> from, std::span<const Entry> to_plans,
           std::span<Kept> to, Key key) noexcept {
  for (std::size_t i = 0; i < to_plans.size(); ++i) {
    for (std::size_t j = 0; j < from_plans.size(); ++j) {
      if (from_plans[j].*key == to_plans[i].*key) to[i] = from[j];
    }
  }
}

}  // namespace

void carry_over(const Plan& from_plan, const State& from, const Plan& to_plan,
                State& to) noexcept HAPTICD_NONBLOCKING {
  std::copy(from.axes.begin(), from.axes.end(), to.axes.begin());
  std::copy(from.ledger.begin(), from.ledger.end(), to.ledger.begin());
  std::copy(from.linkages.begin(), from.linkages.end(), to.linkages.begin());
  std::copy(from.jacobian.begin(), from.jacobian.end(), to.jacobian.begin());
  for (const auto part :
       {&State::q, &State::qd, &State::effort, &State::x, &State::force, &State::work, &State::fade,
        &State::v, &State::slewed, &State::feedforward, &State::beside, &State::contact_delivered,
        &State::reach, &State::ramp}) {
    std::copy((from.*part).begin(), (from.*part).end(), (to.*part).begin());
  }
  carry(from_plan.homings, from.homings, to_plan.homings, to.homings, &HomingPlan::axis);
  carry(from_plan.low_passes, from.low_passes, to_plan.low_passes, to.low_passes,
        &LowPassPlan::axis);
  carry(from_plan.least_squares, from.least_squares, to_plan.least_squares, to.least_squares,
        &LeastSquaresPlan::axis);
  carry(from_plan.foaws, from.foaws, to_plan.foaws, to.foaws, &FoawPlan::axis);
  carry(from_plan.alpha_beta_gammas, from.alpha_beta_gammas, to_plan.alpha_beta_gammas,
        to.alpha_beta_gammas, &AlphaBetaGammaPlan::axis);
  carry(from_plan.axis_observers, from.axis_observers, to_plan.axis_observers, to.axis_observers,
        &ObserverPlan::source);
  carry(from_plan.contact_observers, from.contact_observers, to_plan.contact_observers,
        to.contact_observers, &ObserverPlan::source);
  carry(from_plan.passivity_controllers, from.passivity_controllers, to_plan.passivity_controllers,
        to.passivity_controllers, &PassivityPlan::device);
  carry(from_plan.thermals, from.heat, to_plan.thermals, to.heat, &ThermalPlan::axis);
  carry_scene(from_plan, from, to_plan, to);
  to.mode = from.mode;
  to.fault = from.fault;
  to.adopted = true;
}

}  // namespace hapticd::control
