#include "control/guard/passivity_controller.h"

#include <algorithm>

#include "control/plan.h"
#include "control/scene/render.h"
#include "control/state.h"

namespace hapticd::control {
namespace {

constexpr double kAheadTicks = 4;

/// J per tick that the contact force of the device does at the present speed.
double work_per_tick(const DevicePlan& device, const Plan& plan, const State& state) noexcept {
  double power = 0;
  for (std::size_t i = 0; i < device.coordinates; ++i) {
    const std::size_t c = device.first_coordinate + i;
    power += state.force[c] * state.v[c];
  }
  return std::max(0.0, power * plan.period_s);
}

double next_gain(const PassivityPlan& plan, const PassivityState& at, double need) noexcept {
  if (!(at.reserve > 0)) return 0;
  const double most = std::min(1.0, at.gain + plan.rise);
  return at.reserve < most * need ? at.reserve / need : most;
}

void weaken(State& state, const DevicePlan& device, double gain) noexcept {
  for (std::size_t i = 0; i < device.coordinates; ++i) {
    const std::size_t c = device.first_coordinate + i;
    state.force[c] *= gain;
    state.limited[c] = state.scene_force[c] - state.force[c];
  }
}

/// One tick under force.
void spend(const Plan& plan, State& state, const PassivityPlan& controller,
           PassivityState& at) noexcept {
  const DevicePlan& device = plan.devices[controller.device];
  const double stored = stored_energy(plan, state, device);
  const double ahead = kAheadTicks * work_per_tick(device, plan, state);
  at.reserve += controller.credit * at.damped - at.work;
  at.reserve -= controller.leak * std::max(0.0, at.reserve);
  at.gain = next_gain(controller, at, std::max(stored, ahead));
  at.reserve = std::min(at.reserve, at.gain * stored + controller.budget);
  weaken(state, device, at.gain);
}

}  // namespace

void control_passivity(const Plan& plan, State& state, Findings& findings) noexcept {
  for (std::size_t i = 0; i < plan.passivity_controllers.size(); ++i) {
    const PassivityPlan& controller = plan.passivity_controllers[i];
    PassivityState& at = state.passivity_controllers[i];
    if (!at.running) {
      at.reserve = controller.budget;
      at.gain = 1;
    }
    at.running = state.mode == Mode::enabled;
    if (at.running) spend(plan, state, controller, at);
    if (at.gain < 1) findings.limits.set(Limit::passivity);
    state.reserve[controller.device] = at.reserve;
    state.gain[controller.device] = at.gain;
  }
}

}  // namespace hapticd::control
