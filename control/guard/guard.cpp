#include "control/guard/guard.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "control/guard/mode.h"
#include "control/guard/passivity_controller.h"

namespace hapticd::control {
namespace {

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

/// The force before the fade, coming from `last`.
Force limited(const DevicePlan& device, const Force& scene_force, const Force& last, double& ramp,
              bool adopted, Findings& findings) noexcept {
  const auto ramped = [&] {
    Force force = scene_force;
    for (double& component : force) component *= ramp;
    if (limit_norm(force, device.max_force)) findings.limits.set(Limit::force);
    return force;
  };
  Force change = difference(ramped(), last);
  if (adopted && square(change) > device.max_slew * device.max_slew) {
    ramp =
        0;  // a new plan may not step: fade from what the hand feels now to nothing, then in again
    change = difference(ramped(), last);
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

/// 1 while every axis is at most one tick old; from the second stale tick on it falls to nothing by
/// the tick after which the fault comes.
double freshness_share(const DevicePlan& device, const State& state) noexcept {
  std::uint32_t stale = 0;
  for (std::size_t i = 0; i < device.axes; ++i)
    stale = std::max(stale, state.axes[device.first_axis + i].stale_ticks);
  if (stale <= 1) return 1;
  return std::max(0.0, 1 - static_cast<double>(stale - 1) / device.max_stale_ticks);
}

/// What takes force out at once, without the passivity controllers.
void fade(const Plan& plan, State& state, Findings& findings) noexcept {
  const bool held = findings.limits.has(Limit::sample_held);
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const DevicePlan& device = plan.devices[d];
    double target = state.reach[d];
    if (held) {
      const double share = freshness_share(device, state);
      if (share < 1) findings.limits.set(Limit::stale);
      target *= share;
    }
    state.fade[d] = std::min(target, state.fade[d] + device.ramp_per_tick);
  }
}

void guard_devices(const Plan& plan, State& state, Findings& findings) noexcept {
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const DevicePlan& device = plan.devices[d];
    state.ramp[d] = advance_ramp(state.ramp[d], device.ramp_per_tick, findings.enable);
    const Force scene_force = load(state.scene_force, device);
    Force force = limited(device, scene_force, load(state.slewed, device), state.ramp[d],
                          state.adopted, findings);
    store(force, device, state.slewed);
    for (double& component : force) component *= state.fade[d];
    store(force, device, state.force);
    store(difference(scene_force, force), device, state.limited);
  }
  state.adopted = false;
}

}  // namespace

void guard(const Plan& plan, State& state, Findings& findings) noexcept {
  fade(plan, state, findings);
  if (state.mode == Mode::enabled) {
    guard_devices(plan, state, findings);
  } else {
    zero_force(state);
  }
  control_passivity(plan, state, findings);
}

}  // namespace hapticd::control
