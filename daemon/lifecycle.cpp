#include "daemon/lifecycle.h"

#include <fmt/format.h>

namespace hapticd::daemon {

State next_state(State now, const Seen& seen) noexcept {
  if (!seen.looping) {
    const bool starting = seen.starting && (now == State::off || now == State::connecting);
    return starting ? State::connecting : State::off;
  }
  switch (seen.mode) {
    case control::Mode::idle:
      return State::ready;
    case control::Mode::homing:
      return State::homing;
    case control::Mode::enabled:
      return State::enabled;
    case control::Mode::fault:
      return State::fault;
  }
  return State::fault;
}

std::string_view fault_unit(Fault code, bool rotary) noexcept {
  const std::string_view unit = entry(code).unit;
  if (!unit.empty()) return unit;
  switch (code) {  // "" in the table: the axis' own unit, or no figure at all
    case Fault::velocity:
      return rotary ? "rad/s" : "m/s";
    case Fault::encoder_jump:
    case Fault::travel:
      return rotary ? "rad" : "m";
    default:
      return "";
  }
}

std::string_view fault_unit(const FaultReport& fault, const build::ProgramSpec& spec) noexcept {
  return fault_unit(fault.code, fault.axis < spec.rotary.size() && spec.rotary[fault.axis]);
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
  if (const auto unit = fault_unit(fault, names); !unit.empty()) {
    text +=
        fmt::format(": found {:.4g} {}, allowed {:.4g} {}", fault.found, unit, fault.allowed, unit);
  }
  if (!device_text.empty()) text += fmt::format("; the driver says: {}", device_text);
  text += fmt::format(" (set by: {}). What to do: {}", row.set_by, row.action);
  return text;
}

}  // namespace hapticd::daemon
