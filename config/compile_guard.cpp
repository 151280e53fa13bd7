// What only some devices name of their guard: power, workspace, digital inputs, passivity
// controller.
#include <cmath>

#include "config/compilation.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// Path of a key of the guard: the device's own where it names it.
template <class T>
std::string guard_path(const DevicePlace& place, const std::optional<T>& own, const char* key) {
  return (own ? place.path + "." : "") + "guard." + key;
}

void add_workspace(Compilation& compilation, const DevicePlace& place) {
  if (!place.guard.workspace) return;
  const WorkspaceBox& box = *place.guard.workspace;
  const std::string path = guard_path(place, place.device.guard.workspace, "workspace");
  for (std::size_t i = 0; i < box.min_m.size(); ++i) {
    if (box.min_m[i] < box.max_m[i]) continue;
    compilation.refuse(indexed(path + ".max_m", i), "expected more than min_m, " +
                                                        format_number(box.min_m[i]) + " m, found " +
                                                        format_number(box.max_m[i]) + " m");
  }
  control::WorkspacePlan plan{.device = place.index};
  for (std::size_t i = 0; i < place.frame.directions.size(); ++i) {
    plan.min[i] = box.min_m[place.frame.directions[i]];
    plan.max[i] = box.max_m[place.frame.directions[i]];
  }
  compilation.spec.workspaces.push_back(plan);
}

void add_enable_inputs(Compilation& compilation, const DevicePlace& place) {
  std::uint32_t seen = 0;
  for (std::size_t i = 0; i < place.device.enable_inputs.size(); ++i) {
    const EnableInput& input = place.device.enable_inputs[i];
    const std::uint32_t mask = std::uint32_t{1} << static_cast<unsigned>(input.bit);
    if ((seen & mask) != 0) {
      compilation.refuse(
          indexed(place.path + ".enable_inputs", i) + ".bit",
          "input " + std::to_string(input.bit) + " is named before; one input has one role");
    }
    seen |= mask;
    compilation.spec.enable_inputs.push_back({.device = place.index,
                                              .mask = mask,
                                              .active = input.active ? mask : 0,
                                              .estop = input.role == InputRole::estop});
  }
}

void add_passivity_controller(build::ProgramSpec& spec, const DevicePlace& place) {
  if (!place.guard.passivity_controller) return;
  const PassivityController& wanted = *place.guard.passivity_controller;
  spec.passivity_controllers.push_back(
      {.device = place.index,
       .budget = wanted.budget_J,
       .credit = wanted.damping_share,
       .leak = wanted.leak_s ? -std::expm1(-spec.period_s / *wanted.leak_s) : 0,
       .rise = spec.devices[place.index].ramp_per_tick});
}

}  // namespace

void compile_guard(Compilation& compilation, const DevicePlace& place) {
  if (place.guard.max_power_W) {
    compilation.spec.power_limits.push_back(
        {.device = place.index, .max_W = *place.guard.max_power_W});
  }
  add_workspace(compilation, place);
  add_enable_inputs(compilation, place);
  add_passivity_controller(compilation.spec, place);
}

}  // namespace hapticd::config
