#include "control/observer/compensation.h"

#include <algorithm>
#include <cmath>

#include "control/kinematics/kinematics.h"
#include "control/plan.h"
#include "control/state.h"
#include "control/step.h"

namespace hapticd::control {
namespace {

/// A reading that is no number leaves the last one standing.
void measure_hands(const Plan& plan, State& state, std::span<const Aux> aux) noexcept {
  for (const ForceSensor& sensor : plan.force_sensors) {
    const DevicePlan& device = plan.devices[sensor.device];
    for (std::size_t row = 0; row < device.coordinates; ++row) {
      double force = 0;
      for (std::size_t i = 0; i < sensor.channels; ++i)
        force += sensor.turn[row][i] * aux[sensor.device].analogue[i];
      if (std::isfinite(force)) state.hand_force[device.first_coordinate + row] = force;
    }
  }
}

/// The weights of all tips in one go through J'; without tips, zeros to add to.
void hold_tips(const Plan& plan, State& state) noexcept {
  if (plan.gravity_tips.empty()) {
    std::fill(state.gravity.begin(), state.gravity.end(), 0.0);
    return;
  }
  std::array<double, kMaxCoordinates> weight{};
  for (const GravityTip& tip : plan.gravity_tips) {
    const DevicePlan& device = plan.devices[tip.device];
    for (std::size_t i = 0; i < device.coordinates; ++i)
      weight[device.first_coordinate + i] += tip.weight[i];
  }
  transpose(plan, state, std::span(weight).first(plan.coordinates), state.gravity);
}

bool has_mass(const Serial& chain) noexcept {
  const auto heavy = [](const DhJoint& joint) { return joint.mass > 0; };
  return std::any_of(chain.joint.begin(), chain.joint.begin() + chain.joints, heavy);
}

void hold_links(const Plan& plan, State& state) noexcept {
  for (const Serial& chain : plan.serials) {
    if (!has_mass(chain)) continue;
    const std::size_t first = plan.linkages[chain.linkage].first_axis;
    std::array<double, kMaxJoints> effort{};
    holding_efforts(chain, state.q.data() + first, chain.gravity, effort.data());
    for (std::size_t i = 0; i < chain.joints; ++i) state.gravity[first + i] += effort[i];
  }
}

void hold_weight(const Plan& plan, State& state) noexcept {
  if (state.gravity.empty()) return;
  hold_tips(plan, state);
  hold_links(plan, state);
  for (const GravityAxis& axis : plan.gravity_axes)
    state.gravity[axis.axis] +=
        axis.constant + axis.swing * std::cos(state.q[axis.axis] + axis.phase);
}

void help_against_friction(const Plan& plan, State& state) noexcept {
  for (const FrictionAxis& axis : plan.frictions) {
    const double qd = state.qd[axis.axis];
    state.friction[axis.axis] =
        axis.viscous * qd + axis.coulomb * std::clamp(qd / axis.smooth, -1.0, 1.0);
  }
}

bool at_bound(const ObserverPlan& observer, double output) noexcept {
  return std::abs(output) >= observer.max_output;
}

/// What of the last effort held weight, friction or the ends of the travel at bay belongs to the
/// plant as the observer knows it: its command is the rest. Returns whether a bound bites.
bool observe_axes(const Plan& plan, State& state, std::span<const double> delivered) noexcept {
  if (plan.axis_observers.empty()) return false;
  std::array<double, kMaxAxes> hand;  // filled as far as there are axes
  std::fill_n(hand.begin(), plan.axes.size(), 0.0);
  if (!plan.force_sensors.empty()) transpose(plan, state, state.hand_force, hand);
  bool bites = false;
  for (std::size_t i = 0; i < plan.axis_observers.size(); ++i) {
    const ObserverPlan& observer = plan.axis_observers[i];
    ObserverState& observed = state.axis_observers[i];
    const std::size_t axis = observer.source;
    const double command = delivered[axis] - state.feedforward[axis];
    const double output =
        observe(observer, observed, state.axes[axis].motion, state.q[axis], command, hand[axis]);
    state.observer[axis] = output;
    state.residual[axis] = observed.residual;
    bites |= at_bound(observer, output);
  }
  return bites;
}

/// A contact has moved on as a whole only if every axis of its device has.
Motion worst_motion(const DevicePlan& device, std::span<const AxisState> axes) noexcept {
  Motion worst = Motion::advanced;
  for (const AxisState& axis : axes.subspan(device.first_axis, device.axes))
    worst = std::max(worst, axis.motion);
  return worst;
}

bool observe_contacts(const Plan& plan, State& state) noexcept {
  bool bites = false;
  for (std::size_t i = 0; i < plan.contact_observers.size(); ++i) {
    const ObserverPlan& observer = plan.contact_observers[i];
    ObserverState& observed = state.contact_observers[i];
    const std::size_t at = observer.source;
    const Motion motion = worst_motion(plan.devices[observer.device], state.axes);
    const double hand = plan.force_sensors.empty() ? 0 : state.hand_force[at];
    const double output =
        observe(observer, observed, motion, state.x[at], state.contact_delivered[at], hand);
    state.observer_force[at] = output;
    state.contact_residual[at] = observed.residual;
    bites |= at_bound(observer, output);
  }
  return bites;
}

}  // namespace

void compensate(const Plan& plan, State& state, const TickInput& input,
                Findings& findings) noexcept {
  measure_hands(plan, state, input.aux);
  hold_weight(plan, state);
  help_against_friction(plan, state);
  const bool axis_bites = observe_axes(plan, state, input.delivered);
  const bool contact_bites = observe_contacts(plan, state);
  const bool forces_on = state.mode == Mode::enabled;
  if (forces_on && (axis_bites || contact_bites)) findings.limits.set(Limit::compensation);
}

}  // namespace hapticd::control
