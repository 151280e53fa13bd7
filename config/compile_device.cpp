// One device of the config to the plan's arrays and to what the stability check may assume.
#include <algorithm>
#include <cmath>
#include <limits>

#include "config/compilation.h"
#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

constexpr double kMaxStepTicks = 10;  // a step of more than this many ticks at full speed is a jump
constexpr double kStuckEffortShare =
    0.2;  // of the force limit: under less an axis may well stand still

/// Smallest number of bits whose half range is more than `counts`.
int bits_for(double counts) {
  int bits = 1;
  while (std::ldexp(1.0, bits - 1) <= counts) ++bits;
  return bits;
}

void check_directions(Compilation& compilation, const DevicePlace& place) {
  const std::vector<Direction>& directions = place.device.kinematics.cartesian.directions;
  const std::string path = place.path + ".kinematics.cartesian.directions";
  if (directions.size() != place.device.axes.size()) {
    compilation.refuse(path, "expected one direction for each of the " +
                                 std::to_string(place.device.axes.size()) + " axes, found " +
                                 std::to_string(directions.size()));
  }
  for (std::size_t i = 0; i < directions.size(); ++i) {
    const auto before = directions.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(directions.begin(), before, directions[i]) != before) {
      compilation.refuse(
          indexed(path, i),
          "direction '" + std::string(word_of(directions[i])) +
              "' is taken by another axis; two motors on one direction are not supported");
    }
  }
}

void check_force_limit(Compilation& compilation, const DevicePlace& place) {
  const double actuator_N = smallest_actuator_N(place.device);
  if (place.guard.max_force_N <= actuator_N) return;
  const std::string own = place.path + ".guard.max_force_N";
  const bool is_own = place.device.guard.max_force_N.has_value();
  compilation.refuse(is_own ? own : "guard.max_force_N",
                     "expected at most " + format_number(actuator_N) +
                         " N, what the weakest actuator of device '" + place.device.name +
                         "' delivers, found " + format_number(place.guard.max_force_N) + " N" +
                         (is_own ? "" : "; give that device its own: " + own));
}

/// The wrap of the encoder must be told from motion: a jump has to be less than half of its range.
void check_range(Compilation& compilation, const DevicePlace& place, const std::string& axis_path,
                 const Encoder& encoder) {
  const double counts = kMaxStepTicks * place.guard.max_velocity_m_s * compilation.spec.period_s *
                        encoder.counts_per_m;
  if (encoder.bits == 0 || std::ldexp(1.0, encoder.bits - 1) > counts) return;
  compilation.refuse(axis_path + ".encoder.bits",
                     "expected at least " + std::to_string(bits_for(counts)) + " bits, found " +
                         std::to_string(encoder.bits) + ": at guard.max_velocity_m_s " +
                         format_number(place.guard.max_velocity_m_s) +
                         " a wrap of the encoder could not be told from a jump; lower that limit, "
                         "or use more bits");
}

control::AxisPlan axis_plan(const Axis& axis, const EffectiveGuard& guard, double period_s) {
  const Encoder& encoder = axis.encoder;
  return {.unit_per_raw = (encoder.reversed ? -1 : 1) / encoder.counts_per_m,
          .offset = encoder.offset_m,
          .modulus_raw = encoder.bits > 0 ? std::ldexp(1.0, encoder.bits) : 0,
          .max_effort = axis.actuator.max_force_N,
          .max_velocity = guard.max_velocity_m_s,
          .max_step = kMaxStepTicks * guard.max_velocity_m_s * period_s};
}

control::DevicePlan device_plan(const build::ProgramSpec& spec, const DevicePlace& place) {
  const auto first = static_cast<std::uint16_t>(spec.axes.size());
  const auto count = static_cast<std::uint16_t>(place.device.axes.size());
  const EffectiveGuard& guard = place.guard;
  return {.first_axis = first,
          .axes = count,
          .first_coordinate =
              first,  // Cartesian: a contact has as many coordinates as its device has axes
          .coordinates = count,
          .max_force = guard.max_force_N,
          .max_slew = guard.max_slew_N_s * spec.period_s,
          .ramp_per_tick = guard.ramp_s > spec.period_s ? spec.period_s / guard.ramp_s : 1,
          .max_stale_ticks = static_cast<std::uint32_t>(guard.max_stale_ticks)};
}

void add_stuck_watch(build::ProgramSpec& spec, const DevicePlace& place, const Axis& axis) {
  if (!axis.encoder.stuck_s) return;
  const double ticks = std::max(1.0, std::round(*axis.encoder.stuck_s / spec.period_s));
  spec.stuck_watches.push_back({.axis = static_cast<std::uint16_t>(spec.axes.size()),
                                .ticks = static_cast<std::uint32_t>(ticks),
                                .min_effort = kStuckEffortShare * place.guard.max_force_N});
}

/// The least damping that the model leaves; nothing unless every axis has a model.
check::DeviceAssumption assumption(const Device& device) {
  check::DeviceAssumption assumed;
  assumed.name = device.name;
  assumed.latency_s = device.latency_s;
  for (const Axis& axis : device.axes) {
    if (!axis.model) {
      assumed.min_damping.clear();
      break;
    }
    assumed.min_damping.push_back(axis.model->damping_Ns_m * (1 - axis.model->damping_uncertainty));
  }
  return assumed;
}

}  // namespace

void compile_device(Compilation& compilation, const DevicePlace& place) {
  check_directions(compilation, place);
  check_force_limit(compilation, place);
  build::ProgramSpec& spec = compilation.spec;
  const Device& device = place.device;
  spec.devices.push_back(device_plan(spec, place));
  spec.device_names.push_back(device.name);
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    const Axis& axis = device.axes[i];
    check_range(compilation, place, indexed(place.path + ".axes", i), axis.encoder);
    add_stuck_watch(spec, place, axis);
    spec.axes.push_back(axis_plan(axis, place.guard, spec.period_s));
    spec.axis_names.push_back(device.name + "." + axis.name);
  }
  for (const Direction direction : device.kinematics.cartesian.directions) {
    spec.coordinate_names.push_back(device.name + "." + std::string(word_of(direction)));
  }
  compilation.assumed.push_back(assumption(device));
}

}  // namespace hapticd::config
