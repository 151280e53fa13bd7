#include "control/guard/ledger.h"

#include <algorithm>

#include "control/plan.h"
#include "control/state.h"
#include "control/step.h"

namespace hapticd::control {
namespace {

/// The effort in force over one tick that began with the command of `effort`.
double in_force(const AxisPlan& axis, HeldEffort& held, double effort) noexcept {
  const std::size_t n = axis.delay_ticks;
  for (std::size_t age = n + 1; age > 0; --age) held.delivered[age] = held.delivered[age - 1];
  held.delivered[0] = effort;
  return (1 - axis.delay_share) * held.delivered[n] + axis.delay_share * held.delivered[n + 1];
}

void hold(const AxisPlan& axis, HeldEffort& held, double effort, std::int64_t missed) noexcept {
  held.sum += in_force(axis, held, effort);
  ++held.ticks;
  if (missed == 0) return;
  const std::int64_t delayed = std::min<std::int64_t>(missed, kMaxDelayTicks + 2);
  for (std::int64_t i = 0; i < delayed; ++i) held.sum += in_force(axis, held, effort);
  held.sum += static_cast<double>(missed - delayed) * effort;
  held.ticks += static_cast<std::uint32_t>(std::min<std::int64_t>(missed, 1'000'000'000));
}

/// The mean effort since the last fresh sample; a new sum begins.
double take_mean(HeldEffort& held) noexcept {
  const double mean = held.ticks == 1 ? held.sum : held.sum / std::max(1u, held.ticks);
  held.sum = 0;
  held.ticks = 0;
  return mean;
}

double book_delayed(const AxisPlan& axis, const AxisState& now, double q, LedgerState& ledger,
                    double effort, std::int64_t missed) noexcept {
  hold(axis, ledger.effort, effort, missed);
  ledger.moved = 0;
  ledger.moved_ticks = 0;
  if (now.motion == Motion::held || !now.seeded) return 0;
  if (ledger.known) ledger.moved = q - ledger.q;
  ledger.moved_ticks = ledger.effort.ticks;
  ledger.q = q;
  ledger.known = true;
  return take_mean(ledger.effort) * ledger.moved;
}

/// Work of one axis [J]. Without latency, and with a fresh sample after a fresh one, it is the last
/// effort times the way.
double book_axis(const AxisPlan& axis, const AxisState& now, double q, LedgerState& ledger,
                 double effort, std::int64_t missed) noexcept {
  const bool at_once =
      now.motion == Motion::advanced && axis.delay_ticks == 0 && axis.delay_share == 0;
  if (!at_once) return book_delayed(axis, now, q, ledger, effort, missed);
  ledger.moved = q - ledger.q;
  ledger.moved_ticks = 1;
  ledger.q = q;
  return effort * ledger.moved;
}

/// The same for the contact force alone, and what the device's own damping took meanwhile.
void book_contact(const Plan& plan, State& state, const TickInput& input,
                  std::size_t index) noexcept {
  const PassivityPlan& controller = plan.passivity_controllers[index];
  PassivityState& at = state.passivity_controllers[index];
  const DevicePlan& device = plan.devices[controller.device];
  at.work = at.damped = 0;
  for (std::size_t a = 0; a < device.axes; ++a) {
    const std::size_t i = device.first_axis + a;
    const AxisPlan& axis = plan.axes[i];
    hold(axis, at.effort[a], input.delivered[i] - state.beside[i], input.missed_ticks);
    const LedgerState& ledger = state.ledger[i];
    if (ledger.moved_ticks == 0) continue;
    at.work += take_mean(at.effort[a]) * ledger.moved;
    at.damped += axis.min_damping * ledger.moved * ledger.moved * plan.rate_Hz / ledger.moved_ticks;
  }
}

/// What a contact observer of the device may take for its command.
void deliver_to_contact(const Plan& plan, State& state, const TickInput& input,
                        std::size_t index) noexcept {
  const DevicePlan& device = plan.devices[index];
  std::array<double, kMaxAxesPerDevice> effort{};
  for (std::size_t a = 0; a < device.axes; ++a) {
    const std::size_t i = device.first_axis + a;
    effort[a] = input.delivered[i] - state.feedforward[i];
  }
  double* const force = &state.contact_delivered[device.first_coordinate];
  if (!contact_force(plan, state, index, effort.data(), force))
    std::fill_n(force, device.coordinates, 0.0);
}

}  // namespace

void book(const Plan& plan, State& state, const TickInput& input) noexcept {
  for (std::size_t d = 0; d < plan.devices.size(); ++d) {
    const DevicePlan& device = plan.devices[d];
    double work = 0;
    for (std::size_t i = device.first_axis; i < std::size_t{device.first_axis} + device.axes; ++i) {
      work += book_axis(plan.axes[i], state.axes[i], state.q[i], state.ledger[i],
                        input.delivered[i], input.missed_ticks);
    }
    state.work[d] += work;
  }
  for (std::size_t i = 0; i < plan.passivity_controllers.size(); ++i)
    book_contact(plan, state, input, i);
  std::size_t last = plan.devices.size();
  for (const ObserverPlan& observer : plan.contact_observers) {
    if (observer.device == last) continue;
    last = observer.device;
    deliver_to_contact(plan, state, input, last);
  }
}

}  // namespace hapticd::control
