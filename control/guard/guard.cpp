#include "control/guard/guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace hapticd::control {
namespace {

void fail(State& state, const FaultReport& fault) noexcept {
  if (state.mode == Mode::fault) return;
  state.mode = Mode::fault;
  state.fault = fault;
}

void zero_force(State& state) noexcept {
  std::fill(state.force.begin(), state.force.end(), 0.0);
  std::fill(state.effort.begin(), state.effort.end(), 0.0);
  std::fill(state.ramp.begin(), state.ramp.end(), 0.0);
}

bool all_ramped_out(const State& state) noexcept {
  return std::all_of(state.ramp.begin(), state.ramp.end(), [](double ramp) { return ramp == 0.0; });
}

/// Faults that matter with forces off too: an operator or a device said no. A late tick or a device
/// that is pushed about harms nobody while nothing moves by itself.
bool kept_while_idle(Fault code) noexcept {
  return code == Fault::estop || code == Fault::device;
}

double advance_ramp(double ramp, double per_tick, bool up) noexcept {
  return up ? std::min(1.0, ramp + per_tick) : std::max(0.0, ramp - per_tick);
}

/// A force on a contact; coordinates that it does not have are zero, so that its norms are loops of
/// fixed length.
using Force = std::array<double, kMaxContactCoordinates>;

double square(const Force& force) noexcept {
  double sum = 0;
  for (const double component : force) sum += component * component;
  return sum;
}

/// Scales `force` to norm `limit` where it is longer. True if it did; a NaN passes through to the
/// finite check.
bool limit_norm(Force& force, double limit) noexcept {
  const double squared = square(force);
  if (squared <= limit * limit) return false;
  const double scale = limit / std::sqrt(squared);
  for (double& component : force) component *= scale;
  return true;
}

Force difference(const Force& a, const Force& b) noexcept {
  Force result;
  for (std::size_t i = 0; i < result.size(); ++i) result[i] = a[i] - b[i];
  return result;
}

/// The force that a contact may get this tick, coming from `last`.
Force guarded(const DevicePlan& device, const Force& scene_force, const Force& last, double& ramp,
              bool adopted, Findings& findings) noexcept {
  const auto faded = [&] {
    Force force = scene_force;
    for (double& component : force) component *= ramp;
    if (limit_norm(force, device.max_force)) findings.limits.set(Limit::force);
    return force;
  };
  Force change = difference(faded(), last);
  if (adopted && square(change) > device.max_slew * device.max_slew) {
    ramp =
        0;  // a new plan may not step: fade from what the hand feels now to nothing, then in again
    change = difference(faded(), last);
  }
  if (ramp < 1) findings.limits.set(Limit::ramp);
  if (limit_norm(change, device.max_slew)) findings.limits.set(Limit::slew);
  Force force;
  for (std::size_t i = 0; i < force.size(); ++i) force[i] = last[i] + change[i];
  return force;
}

Force load(std::span<const double> coordinates, const DevicePlan& device) noexcept {
  Force force{};
  for (std::size_t i = 0; i < device.coordinates; ++i)
    force[i] = coordinates[device.first_coordinate + i];
  return force;
}

void store(const Force& force, const DevicePlan& device, std::span<double> coordinates) noexcept {
  for (std::size_t i = 0; i < device.coordinates; ++i)
    coordinates[device.first_coordinate + i] = force[i];
}

}  // namespace

void decide_mode(State& state, const TickInput& input, const Findings& findings) noexcept {
  const bool host_ok = input.host_fault.code == Fault::none;
  const bool healthy = host_ok && findings.fault.code == Fault::none;
  if (state.mode == Mode::fault && input.clear_fault && healthy) {
    state.mode = Mode::idle;
    state.fault = {};
  }
  const bool forces = state.mode == Mode::enabled || input.enable;
  if (!host_ok && (forces || kept_while_idle(input.host_fault.code))) {
    fail(state, input.host_fault);
  } else if (findings.fault.code != Fault::none && forces) {
    fail(state, findings.fault);
  } else if (state.mode == Mode::idle && input.enable && findings.ready) {
    state.mode = Mode::enabled;  // from zero force and a ramp at zero: nothing starts with a kick
  } else if (state.mode == Mode::enabled && !input.enable && all_ramped_out(state)) {
    state.mode = Mode::idle;
  }
}

void guard(const Plan& plan, State& state, Findings& findings, bool enable) noexcept {
  if (state.mode != Mode::enabled) {
    zero_force(state);
    return;
  }
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const DevicePlan& device = plan.devices[d];
    state.ramp[d] = advance_ramp(state.ramp[d], device.ramp_per_tick, enable);
    const Force force = guarded(device, load(state.scene_force, device), load(state.force, device),
                                state.ramp[d], state.adopted, findings);
    store(force, device, state.force);
  }
  state.adopted = false;
}

void limit_effort(const Plan& plan, State& state, Findings& findings) noexcept {
  const std::span<const AxisPlan> axes = plan.axes;
  const std::span<double> efforts = state.effort;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    double& effort = efforts[i];
    const double limit = axes[i].max_effort;
    if (std::abs(effort) <= limit) continue;
    if (!std::isfinite(effort)) {
      findings.report({.code = Fault::output_not_finite,
                       .axis = static_cast<std::uint16_t>(i),
                       .found = effort});
      fail(state, findings.fault);
      zero_force(state);
      return;
    }
    effort = std::copysign(limit, effort);
    findings.limits.set(Limit::actuator);
  }
}

}  // namespace hapticd::control
