// One device of the config as a whole: its place among the others, its force limits, its names.
#include <cmath>

#include "config/compilation.h"
#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// Path of a key of the guard: the device's own where it names it.
std::string guard_path(const DevicePlace& place, bool is_own, const std::string& key) {
  return (is_own ? place.path + "." : "") + "guard." + key;
}

void check_force_limit(Compilation& compilation, const DevicePlace& place) {
  const Device& device = place.device;
  const bool is_own = device.guard.max_force_N.has_value();
  const std::string own = guard_path(place, true, "max_force_N");
  if (!std::holds_alternative<Cartesian>(device.kinematics)) {
    if (!std::isnan(place.guard.max_force_N)) return;
    compilation.refuse(own,
                       "missing; expected here: max_force_N, the most that the hand is to feel; on "
                       "a linkage it does not follow from the actuators");
    return;
  }
  const double actuator_N = smallest_actuator_N(device);
  if (place.guard.max_force_N <= actuator_N) return;
  compilation.refuse(guard_path(place, is_own, "max_force_N"),
                     "expected at most " + format_number(actuator_N) +
                         " N, what the weakest actuator of device '" + device.name +
                         "' delivers, found " + format_number(place.guard.max_force_N) + " N" +
                         (is_own ? "" : "; give that device its own: " + own));
}

void check_latency(Compilation& compilation, const DevicePlace& place) {
  const double most_s = static_cast<double>(kMaxDelayTicks) * compilation.spec.period_s;
  if (place.device.latency_s <= most_s) return;
  compilation.refuse(place.path + ".latency_s",
                     "expected at most " + std::to_string(kMaxDelayTicks) + " ticks, " +
                         format_number(most_s) + " s at this rate, found " +
                         format_number(place.device.latency_s) + " s; lower loop.rate_Hz");
}

/// A delay that was measured, and surely is longer than the latency that all checks assume.
void check_measured_delays(Compilation& compilation, const DevicePlace& place) {
  for (const NamedModel& model : compilation.document().models) {
    if (!model.measured || !model.path.starts_with(place.path + ".")) continue;
    const Measurement& measured = *model.measured;
    const double surely_s = measured.delay_s - measured.delay_uncertainty_s;
    if (place.device.latency_s >= surely_s) continue;
    compilation.refuse(
        place.path + ".latency_s",
        "expected at least the delay that was measured, " + format_number(measured.delay_s) +
            " +- " + format_number(measured.delay_uncertainty_s) + " s (" + model.file +
            "), found " + format_number(place.device.latency_s) + " s: raise it to " +
            format_number(measured.delay_s + measured.delay_uncertainty_s) +
            " and what the loop may wake late, or identify the axis anew");
  }
}

}  // namespace

DevicePlace device_place(Compilation& compilation, std::size_t index) {
  const build::ProgramSpec& spec = compilation.spec;
  const Device& device = compilation.config.devices[index];
  const std::string path = indexed("devices", index);
  DevicePlace place{.device = device,
                    .index = static_cast<std::uint16_t>(index),
                    .path = path,
                    .guard = effective_guard(compilation.config.guard, device),
                    .frame = contact_frame(compilation, device, path),
                    .axes = {},
                    .first_axis = static_cast<std::uint16_t>(spec.axis_names.size()),
                    .first_coordinate = static_cast<std::uint16_t>(spec.coordinate_names.size())};
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    place.axes.push_back(
        axis_values(compilation, device.axes[i], indexed(path + ".axes", i), place.guard));
  }
  return place;
}

void compile_device(Compilation& compilation, const DevicePlace& place) {
  check_force_limit(compilation, place);
  check_latency(compilation, place);
  check_measured_delays(compilation, place);
  build::ProgramSpec& spec = compilation.spec;
  const EffectiveGuard& guard = place.guard;
  const double scale = place.frame.scale;
  spec.devices.push_back(
      {.first_axis = place.first_axis,
       .axes = static_cast<std::uint16_t>(place.axes.size()),
       .first_coordinate = place.first_coordinate,
       .coordinates = static_cast<std::uint16_t>(place.frame.directions.size()),
       .max_force = guard.max_force_N / scale,
       .max_slew = guard.max_slew_N_s * spec.period_s / scale,
       .ramp_per_tick = guard.ramp_s > spec.period_s ? spec.period_s / guard.ramp_s : 1,
       .max_stale_ticks = static_cast<std::uint32_t>(guard.max_stale_ticks)});
  const Device& device = place.device;
  spec.device_names.push_back(device.name);
  for (const Axis& axis : device.axes) {
    spec.axis_names.push_back(device.name + "." + axis.name);
    spec.rotary.push_back(axis.kind == AxisKind::rotary);
  }
  for (const std::size_t direction : place.frame.directions) {
    spec.coordinate_names.push_back(device.name + "." +
                                    std::string(word_of(static_cast<Direction>(direction))));
  }
}

}  // namespace hapticd::config
