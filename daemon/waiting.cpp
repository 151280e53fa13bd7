#include "daemon/waiting.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace hapticd::daemon {
namespace {

/// One line for each bit of the input that is wrong.
void add_input(const control::EnableInput& input, const std::string& device, std::uint32_t digital,
               std::vector<std::string>& lines) {
  const std::uint32_t wrong = (digital ^ input.active) & input.mask;
  for (std::uint32_t rest = wrong; rest != 0; rest &= rest - 1) {
    const int bit = std::countr_zero(rest);
    const bool wanted = ((input.active >> bit) & 1u) != 0;
    lines.push_back(
        fmt::format("{}: {} bit {} is {} and has to be {}; {}", input.estop ? "e-stop" : "dead-man",
                    device, bit, wanted ? 0 : 1, wanted ? 1 : 0,
                    input.estop ? "release it, then `hapticctl enable`" : "hold it for forces"));
  }
}

std::string how_to_home(const control::HomingPlan& homing) {
  if (homing.by == control::HomingBy::device)
    return "the device has not said yet that its zero is known; let it make its own reference run";
  if (homing.effort != 0) {
    return homing.by == control::HomingBy::index
               ? "`hapticctl enable` moves it slowly to its index pulse; keep hands off"
               : "`hapticctl enable` moves it slowly to its stop; keep hands off";
  }
  return homing.by == control::HomingBy::index ? "move it by hand over its index pulse"
                                               : "move it by hand to its stop";
}

std::string unhomed(const build::ProgramSpec& spec, std::size_t axis) {
  const auto homing =
      std::find_if(spec.homings.begin(), spec.homings.end(),
                   [axis](const control::HomingPlan& plan) { return plan.axis == axis; });
  return fmt::format(
      "{} is not homed: {}", spec.axis_names[axis],
      homing == spec.homings.end() ? "its encoder has given no value yet" : how_to_home(*homing));
}

std::size_t device_of(const build::ProgramSpec& spec, std::size_t axis) {
  std::size_t device = 0;
  while (device < spec.devices.size() &&
         axis >= std::size_t{spec.devices[device].first_axis} + spec.devices[device].axes)
    ++device;
  return device;
}

}  // namespace

std::vector<std::string> waiting_for(const build::ProgramSpec& spec, const LiveView& now,
                                     const std::vector<std::string>& device_words) {
  std::vector<std::string> lines;
  if (!now.known) return lines;
  for (const std::string& words : device_words)
    if (!words.empty()) lines.push_back(words);
  for (const control::EnableInput& input : spec.enable_inputs) {
    if (input.device < now.digital.size())
      add_input(input, spec.device_names[input.device], now.digital[input.device], lines);
  }
  for (std::size_t i = 0; i < std::min(now.homed.size(), spec.axis_names.size()); ++i) {
    const std::size_t device = device_of(spec, i);
    const bool said = device < device_words.size() && !device_words[device].empty();
    if (!now.homed[i] && !said) lines.push_back(unhomed(spec, i));
  }
  return lines;
}

}  // namespace hapticd::daemon
