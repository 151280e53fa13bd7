#include "control/guard/mode.h"

#include <algorithm>

namespace hapticd::control {
namespace {

bool all_ramped_out(const State& state) noexcept {
  return std::all_of(state.ramp.begin(), state.ramp.end(), [](double ramp) { return ramp == 0.0; });
}

/// Faults that matter with forces off too: an operator or a device said no. A late tick or a device
/// that is pushed about harms nobody while nothing moves by itself.
bool kept_while_idle(Fault code) noexcept {
  return code == Fault::estop || code == Fault::device;
}

/// Every dead-man is held. An e-stop that is pressed is reported.
bool inputs_agree(const Plan& plan, const TickInput& input, Findings& findings) noexcept {
  bool agree = true;
  for (const EnableInput& at : plan.enable_inputs) {
    if ((input.aux[at.device].digital & at.mask) == at.active) continue;
    agree = false;
    if (at.estop) findings.report({.code = Fault::estop, .device = at.device});
  }
  return agree;
}

Mode next_mode(const State& state, const Findings& findings) noexcept {
  const bool wanted = findings.enable && findings.ready;
  switch (state.mode) {
    case Mode::idle:
      if (wanted && findings.homed)
        return Mode::enabled;  // ramp at zero: nothing starts with a kick
      return wanted && findings.search ? Mode::homing : Mode::idle;
    case Mode::homing:
      if (!wanted) return Mode::idle;
      if (findings.homed) return Mode::enabled;
      return findings.search ? Mode::homing : Mode::idle;
    case Mode::enabled:
      return !findings.enable && all_ramped_out(state) ? Mode::idle : Mode::enabled;
    case Mode::fault:
      break;
  }
  return state.mode;
}

}  // namespace

void fail(State& state, const FaultReport& fault) noexcept {
  if (state.mode == Mode::fault) return;
  state.mode = Mode::fault;
  state.fault = fault;
}

void zero_force(State& state) noexcept {
  for (const auto part : {&State::force, &State::slewed, &State::effort, &State::ramp,
                          &State::feedforward, &State::beside}) {
    std::fill((state.*part).begin(), (state.*part).end(), 0.0);
  }
}

void decide_mode(const Plan& plan, State& state, const TickInput& input,
                 Findings& findings) noexcept {
  findings.enable = inputs_agree(plan, input, findings) && input.enable;
  const bool host_ok = input.host_fault.code == Fault::none;
  const FaultReport& fault = host_ok ? findings.fault : input.host_fault;
  if (state.mode == Mode::fault && input.clear_fault && fault.code == Fault::none) {
    state.mode = Mode::idle;
    state.fault = {};
  }
  const bool forces = state.mode == Mode::enabled || state.mode == Mode::homing || input.enable;
  if (fault.code != Fault::none && (forces || kept_while_idle(fault.code))) {
    fail(state, fault);
  } else {
    state.mode = next_mode(state, findings);
  }
}

}  // namespace hapticd::control
