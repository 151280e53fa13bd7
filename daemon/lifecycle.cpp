#include "daemon/lifecycle.h"

#include <fmt/format.h>

namespace hapticd::daemon {

State next_state(State now, const Seen& seen) noexcept {
  switch (now) {
    case State::off:
      return seen.starting ? State::connecting : State::off;
    case State::connecting:
      if (!seen.starting) return State::off;
      return seen.connected ? State::homing : State::connecting;
    case State::homing:
      if (!seen.connected) return State::off;
      return seen.homed && seen.looping ? State::ready : State::homing;
    case State::ready:
    case State::enabled:
    case State::fault:
      break;
  }
  if (!seen.looping) return State::off;
  switch (seen.mode) {
    case control::Mode::idle:
      return State::ready;
    case control::Mode::enabled:
      return State::enabled;
    case control::Mode::fault:
      return State::fault;
  }
  return State::fault;
}

std::string_view fault_unit(const FaultReport& fault) noexcept {
  const std::string_view unit = entry(fault.code).unit;
  if (!unit.empty()) return unit;
  // "" in the table: the axis' own unit, or no figure at all. Axes are linear so far.
  switch (fault.code) {
    case Fault::velocity:
      return "m/s";
    case Fault::encoder_jump:
      return "m";
    default:
      return "";
  }
}

std::string blamed(const FaultReport& fault, const build::ProgramSpec& names) {
  if (fault.axis < names.axis_names.size()) return names.axis_names[fault.axis];
  if (fault.device < names.device_names.size()) return names.device_names[fault.device];
  return {};
}

std::string describe_fault(const FaultReport& fault, const build::ProgramSpec& names,
                           std::string_view device_text) {
  const FaultEntry& row = entry(fault.code);
  std::string text = fmt::format("{}: {}", row.name, row.meaning);
  if (const std::string who = blamed(fault, names); !who.empty()) text += fmt::format("; {}", who);
  if (const auto unit = fault_unit(fault); !unit.empty()) {
    text +=
        fmt::format(": found {:.4g} {}, allowed {:.4g} {}", fault.found, unit, fault.allowed, unit);
  }
  if (!device_text.empty()) text += fmt::format("; the driver says: {}", device_text);
  text += fmt::format(" (set by: {}). What to do: {}", row.set_by, row.action);
  return text;
}

}  // namespace hapticd::daemon
