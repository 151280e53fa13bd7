#include "control/guard/actuate.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "control/guard/mode.h"
#include "control/kinematics/kinematics.h"

namespace hapticd::control {
namespace {

constexpr double kWarm = 0.9;  // heat from which on a motor's effort is bounded

void search_reference(const Plan& plan, State& state) noexcept {
  std::fill(state.effort.begin(), state.effort.end(), 0.0);
  for (std::size_t i = 0; i < plan.homings.size(); ++i)
    state.effort[plan.homings[i].axis] = state.homings[i].effort;
}

double at(std::span<const double> values, std::size_t i) noexcept {
  return values.empty() ? 0 : values[i];
}

/// Whether anything but contact forces makes efforts.
bool has_compensation(const State& state) noexcept {
  return !state.gravity.empty() || !state.friction.empty() || !state.observer.empty() ||
         !state.travel.empty();
}

/// J' observer_force into state.beside.
void transpose_observers(const Plan& plan, State& state) noexcept {
  if (plan.contact_observers.empty()) return;
  transpose(plan, state, state.observer_force, state.beside);
}

void add_compensation(const Plan& plan, State& state) noexcept {
  transpose_observers(plan, state);
  const bool axis_terms = has_compensation(state);
  if (!axis_terms && plan.contact_observers.empty()) return;
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const DevicePlan& device = plan.devices[d];
    const double share = state.ramp[d] * state.fade[d];
    for (std::size_t i = device.first_axis; i < std::size_t{device.first_axis} + device.axes; ++i) {
      const double contact = plan.contact_observers.empty() ? 0 : state.beside[i];
      state.feedforward[i] =
          share * (at(state.gravity, i) + at(state.friction, i) + at(state.travel, i));
      state.beside[i] = share * (contact + at(state.observer, i)) + state.feedforward[i];
      state.effort[i] += state.beside[i];
    }
  }
}

bool clamp(double& effort, double limit) noexcept {
  if (std::abs(effort) <= limit) return false;
  effort = std::copysign(limit, effort);
  return true;
}

/// Heat by what is asked now, so that it can never pass 1 by a tick's delay.
void limit_temperature(const Plan& plan, State& state, Findings& findings) noexcept {
  for (std::size_t i = 0; i < plan.thermals.size(); ++i) {
    const ThermalPlan& motor = plan.thermals[i];
    double& heat = state.heat[i];
    double& effort = state.effort[motor.axis];
    if (heat > kWarm) {
      const double max = std::max(motor.continuous, plan.axes[motor.axis].max_effort);
      const double cold = std::max(0.0, (1 - heat) / (1 - kWarm));
      if (clamp(effort, motor.continuous + cold * (max - motor.continuous)))
        findings.limits.set(Limit::temperature);
    }
    const double load = effort / motor.continuous;
    heat += motor.share * (load * load - heat);
  }
}

void limit_power(const Plan& plan, State& state, Findings& findings) noexcept {
  for (const PowerLimit& limit : plan.power_limits) {
    const DevicePlan& device = plan.devices[limit.device];
    double power = 0;
    for (std::size_t i = device.first_axis; i < std::size_t{device.first_axis} + device.axes; ++i)
      power += state.effort[i] * state.qd[i];
    if (power <= limit.max_W) continue;
    for (std::size_t i = device.first_axis; i < std::size_t{device.first_axis} + device.axes; ++i)
      state.effort[i] *= limit.max_W / power;
    findings.limits.set(Limit::power);
  }
}

/// False: an effort is not a number.
bool limit_effort(const Plan& plan, State& state, Findings& findings) noexcept {
  const std::span<const AxisPlan> axes = plan.axes;
  const std::span<double> efforts = state.effort;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (std::abs(efforts[i]) <= axes[i].max_effort) continue;
    if (!std::isfinite(efforts[i])) {
      findings.report({.code = Fault::output_not_finite,
                       .axis = static_cast<std::uint16_t>(i),
                       .found = efforts[i]});
      return false;
    }
    efforts[i] = std::copysign(axes[i].max_effort, efforts[i]);
    findings.limits.set(Limit::actuator);
  }
  return true;
}

}  // namespace

void actuate(const Plan& plan, State& state, Findings& findings) noexcept {
  if (state.mode == Mode::homing) {
    search_reference(plan, state);
  } else if (state.mode == Mode::enabled) {
    transpose(plan, state, state.force, state.effort);
    add_compensation(plan, state);
  }
  if (!limit_effort(plan, state, findings)) {
    fail(state, findings.fault);
    zero_force(state);
    return;
  }
  limit_temperature(plan, state, findings);
  limit_power(plan, state, findings);
}

}  // namespace hapticd::control
