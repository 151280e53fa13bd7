#include "config/effective_guard.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace hapticd::config {
namespace {

constexpr double kMaxVelocity_m_s = 1.5;
constexpr double kMaxVelocity_rad_s = 10;
constexpr double kFullForceTime_s =
    0.005;  // the default slew limit reaches the force limit in this time
constexpr double kRamp_s = 0.5;
constexpr int kMaxStaleTicks = 3;

template <class T>
T first_of(const std::optional<T>& own, const std::optional<T>& global, T otherwise) {
  return own ? *own : global.value_or(otherwise);
}

template <class T>
std::optional<T> first_of(const std::optional<T>& own, const std::optional<T>& global) {
  return own ? own : global;
}

/// A force limit follows from the actuators only where each of them pushes along a direction of its
/// own.
double default_force_N(const Device& device) {
  return std::holds_alternative<Cartesian>(device.kinematics)
             ? smallest_actuator_N(device)
             : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

double smallest_actuator_N(const Device& device) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Axis& axis : device.axes)
    smallest = std::min(smallest, axis.actuator.max_force_N.value_or(smallest));
  return smallest;
}

EffectiveGuard effective_guard(const Guard& global, const Device& device) {
  const Guard& own = device.guard;
  EffectiveGuard guard;
  guard.max_force_N = first_of(own.max_force_N, global.max_force_N, default_force_N(device));
  guard.max_velocity_m_s =
      first_of(own.max_velocity_m_s, global.max_velocity_m_s, kMaxVelocity_m_s);
  guard.max_velocity_rad_s =
      first_of(own.max_velocity_rad_s, global.max_velocity_rad_s, kMaxVelocity_rad_s);
  guard.max_slew_N_s =
      first_of(own.max_slew_N_s, global.max_slew_N_s, guard.max_force_N / kFullForceTime_s);
  guard.ramp_s = first_of(own.ramp_s, global.ramp_s, kRamp_s);
  guard.max_stale_ticks = first_of(own.max_stale_ticks, global.max_stale_ticks, kMaxStaleTicks);
  guard.max_power_W = first_of(own.max_power_W, global.max_power_W);
  guard.workspace = first_of(own.workspace, global.workspace);
  guard.passivity_controller = first_of(own.passivity_controller, global.passivity_controller);
  return guard;
}

}  // namespace hapticd::config
