// The truth of a simulated device. Nothing of it goes into the plan or the stability check.
#include <algorithm>
#include <cmath>

#include "config/axis_units.h"
#include "config/compilation.h"
#include "config/describe.h"
#include "config/linkage_geometry.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// One axis of the device with its truth.
struct SimAxisPlace {
  const Axis& axis;
  const AxisValues& values;
  const SimAxis& truth;
  AxisUnits units;  ///< of the truth's map
};

std::optional<sim::StopOptions> stops(const SimAxisPlace& place) {
  const Form linear{"stops_m", place.truth.stops_m};
  const Form rotary{"stops_rad", place.truth.stops_rad};
  const auto ends = place.units.given(linear, rotary);
  if (!ends) return {};
  if ((*ends)[0] >= (*ends)[1]) {
    place.units.refuse(place.units.key(linear, rotary),
                       "expected the lower end, then the upper one, found " +
                           format_number((*ends)[0]) + ", " + format_number((*ends)[1]));
  }
  return sim::StopOptions{.min_m = (*ends)[0], .max_m = (*ends)[1]};
}

sim::AxisOptions axis_options(const SimAxisPlace& place) {
  const SimAxis& truth = place.truth;
  const AxisUnits& units = place.units;
  const ModelValues model = place.values.model.value_or(ModelValues{});
  const double counts = place.values.counts_per_unit;
  return {
      .mass_kg = units.optional(Form{"mass_kg", truth.mass_kg},
                                Form{"inertia_kgm2", truth.inertia_kgm2}, model.inertia),
      .damping_Ns_m = units.optional(Form{"damping_Ns_m", truth.damping_Ns_m},
                                     Form{"damping_Nms_rad", truth.damping_Nms_rad}, model.damping),
      .coulomb_N = units.optional(Form{"coulomb_N", truth.coulomb_N},
                                  Form{"coulomb_Nm", truth.coulomb_Nm}, 0),
      .delay_s = truth.delay_s,
      .position_m = units.optional(Form{"position_m", truth.position_m},
                                   Form{"position_rad", truth.position_rad}, 0),
      .counts_per_m = place.axis.encoder.reversed ? -counts : counts,
      .zero_m = place.values.offset,
      .encoder_bits = place.axis.encoder.bits,
      .noise_counts = truth.noise_counts,
      .dac_step_N = units.optional(Form{"dac_step_N", truth.dac_step_N},
                                   Form{"dac_step_Nm", truth.dac_step_Nm}, 0),
      .max_effort_N = place.values.max_effort,
      .relative = truth.relative,
      .index_m = units.given(Form{"index_m", truth.index_m}, Form{"index_rad", truth.index_rad}),
      .stops = stops(place),
      .homed_at_s = truth.homed_at_s};
}

void check_axis(const SimAxisPlace& place, const sim::AxisOptions& options) {
  const bool rotary = place.values.rotary;
  if (options.mass_kg == 0) {
    place.units.refuse(rotary ? "inertia_kgm2" : "mass_kg",
                       std::string("no ") + (rotary ? "inertia" : "mass") +
                           ": give it here, or in the axis' model");
  }
  if (options.dac_step_N > options.max_effort_N) {
    place.units.refuse(rotary ? "dac_step_Nm" : "dac_step_N",
                       "expected at most what the actuator can deliver, " +
                           format_number(options.max_effort_N) + " " + effort_unit(rotary) +
                           ", found " + format_number(options.dac_step_N) + " " +
                           effort_unit(rotary));
  }
  const double counts = std::abs((options.position_m - options.zero_m) * options.counts_per_m);
  const int bits = place.axis.encoder.bits;
  if (bits > 0 && !options.relative && counts >= std::ldexp(1.0, bits - 1)) {
    place.units.refuse(rotary ? "position_rad" : "position_m",
                       "the encoder of " + std::to_string(bits) +
                           " bits wraps before it gets here; start nearer to encoder." +
                           (rotary ? "offset_rad" : "offset_m"));
  }
  const auto& stops = options.stops;
  if (stops && stops->min_m < stops->max_m &&
      (options.position_m < stops->min_m || options.position_m > stops->max_m)) {
    place.units.refuse(rotary ? "position_rad" : "position_m",
                       "expected a start between the stops");
  }
}

void add_axes(Compilation& compilation, const DevicePlace& place, const Sim& sim,
              sim::DeviceOptions& options) {
  const std::vector<Axis>& axes = place.device.axes;
  const std::string path = place.path + ".sim.axes";
  if (!sim.axes.empty() && sim.axes.size() != axes.size()) {
    compilation.refuse(path, "expected one entry for each of the " + std::to_string(axes.size()) +
                                 " axes, or none at all, found " + std::to_string(sim.axes.size()));
    return;
  }
  const SimAxis as_modelled;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const SimAxisPlace axis{axes[i],
                            place.axes[i],
                            sim.axes.empty() ? as_modelled : sim.axes[i],
                            {compilation, axes[i].kind, indexed(path, i)}};
    options.axes.push_back(axis_options(axis));
    check_axis(axis, options.axes.back());
  }
}

void add_hand(Compilation& compilation, const DevicePlace& place, const SimHand& hand,
              sim::DeviceOptions& options) {
  const std::string path = place.path + ".sim.hand.script";
  options.hand.mass_kg = hand.mass_kg;
  options.hand.stiffness_N_m = hand.stiffness_N_m;
  options.hand.damping_Ns_m = hand.damping_Ns_m;
  for (std::size_t i = 0; i < hand.script.size(); ++i) {
    const SimScriptStep& step = hand.script[i];
    if (i > 0 && step.at_s <= hand.script[i - 1].at_s) {
      compilation.refuse(indexed(path, i) + ".at_s", "expected later than the step before, " +
                                                         format_number(hand.script[i - 1].at_s) +
                                                         " s, found " + format_number(step.at_s) +
                                                         " s");
    }
    options.hand.script.push_back(
        {.at_s = step.at_s, .force_N = step.force_N, .position_m = step.position_m});
  }
}

void add_failures(Compilation& compilation, const DevicePlace& place, const Sim& sim,
                  sim::DeviceOptions& options) {
  std::vector<std::string> names;
  for (const Axis& axis : place.device.axes) names.push_back(axis.name);
  for (std::size_t i = 0; i < sim.failures.size(); ++i) {
    const SimFailure& failure = sim.failures[i];
    const std::string path = indexed(place.path + ".sim.failures", i);
    const auto found =
        failure.axis ? std::find(names.begin(), names.end(), *failure.axis) : names.begin();
    if (found == names.end()) {
      compilation.refuse(path + ".axis", unknown_name("axis", *failure.axis, names));
      continue;
    }
    const auto axis = static_cast<std::size_t>(found - names.begin());
    const AxisUnits units(compilation, place.device.axes[axis].kind, path);
    // Both enumerations list the same kinds in the same order; a test holds them together.
    options.failures.push_back({.kind = static_cast<sim::FailureKind>(failure.kind),
                                .axis = axis,
                                .at_s = failure.at_s,
                                .for_s = failure.for_s,
                                .size_m = units.optional(Form{"size_m", failure.size_m},
                                                         Form{"size_rad", failure.size_rad}, 0)});
  }
}

void add_digital(Compilation& compilation, const DevicePlace& place, const Sim& sim,
                 sim::DeviceOptions& options) {
  for (std::size_t i = 0; i < sim.digital.size(); ++i) {
    const SimDigitalStep& step = sim.digital[i];
    if (i > 0 && step.at_s <= sim.digital[i - 1].at_s) {
      compilation.refuse(indexed(place.path + ".sim.digital", i) + ".at_s",
                         "expected later than the step before, " +
                             format_number(sim.digital[i - 1].at_s) + " s, found " +
                             format_number(step.at_s) + " s");
    }
    options.digital.push_back({.at_s = step.at_s, .bits = step.bits});
  }
}

using Geometry = decltype(sim::LinkageOptions::geometry);

Geometry geometry_of(const Cartesian& cartesian) {
  return linear_map(cartesian);
}
Geometry geometry_of(const FiveBar& bars) {
  return five_bar(bars);
}
Geometry geometry_of(const Delta& legs) {
  return delta(legs);
}
Geometry geometry_of(const Serial& chain) {
  return serial(chain);
}

std::array<double, 3> unit_direction(Compilation& compilation, const std::string& path,
                                     std::array<double, 3> direction) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length > 0)) {
    compilation.refuse(path, "a direction of length 0 points nowhere; for example [1, 0, 0]");
    return direction;
  }
  for (double& part : direction) part /= length;
  return direction;
}

void add_linkage(Compilation& compilation, const DevicePlace& place, const Sim& sim,
                 sim::DeviceOptions& options) {
  if (std::holds_alternative<Cartesian>(place.device.kinematics)) {
    if (sim.linkage == SimLinkage{}) return;
    compilation.refuse(place.path + ".sim.linkage",
                       "the axes of a Cartesian device move independently of each other; put these "
                       "masses into sim.axes");
    return;
  }
  options.linkage = sim::LinkageOptions{
      .geometry =
          std::visit([](const auto& kind) { return geometry_of(kind); }, place.device.kinematics),
      .inner_link_kg = sim.linkage.inner_link_kg,
      .outer_link_kg = sim.linkage.outer_link_kg,
      .tip_kg = sim.linkage.tip_kg,
      .gravity = sim.linkage.gravity_m_s2,
      .hand_direction =
          unit_direction(compilation, place.path + ".sim.hand.direction", sim.hand.direction)};
}

/// The simulated sensor has one channel for each axis, or for x, y, z of a linkage's tip.
std::vector<Direction> sensor_channels(const Device& device) {
  const auto* cartesian = std::get_if<Cartesian>(&device.kinematics);
  return cartesian ? cartesian->directions
                   : std::vector<Direction>{Direction::x, Direction::y, Direction::z};
}

/// A device that has a sensor has a simulated one too: a silent one would make the hand a
/// disturbance.
void add_force_sensor(Compilation& compilation, const DevicePlace& place, const Sim& sim,
                      sim::DeviceOptions& options) {
  const std::optional<ForceSensor>& sensor = place.device.force_sensor;
  if (!sensor && !sim.force_sensor) return;
  options.force_sensor =
      sim::ForceSensorOptions{.noise_N = sim.force_sensor.value_or(SimForceSensor{}).noise_N};
  if (!sensor) return;
  const std::vector<Direction> channels = sensor_channels(place.device);
  const std::vector<Direction>& named = sensor->directions;
  if (named.size() <= channels.size() && std::equal(named.begin(), named.end(), channels.begin()))
    return;
  std::string expected;
  for (const Direction channel : channels)
    expected += (expected.empty() ? "" : ", ") + std::string(word_of(channel));
  compilation.refuse(place.path + ".force_sensor.directions",
                     "expected the first ones of [" + expected +
                         "], as the simulated sensor of this device has them");
}

/// Enough to stand in for the device.
bool has_models(const Device& device) {
  return std::ranges::all_of(device.axes, [](const Axis& axis) { return axis.model.has_value(); });
}

}  // namespace

void compile_simulated(Compilation& compilation, const DevicePlace& place) {
  const Device& device = place.device;
  sim::DeviceOptions options;
  options.name = device.name;
  options.period_s = compilation.spec.period_s;
  if (device.driver == Driver::sim || device.sim || has_models(device)) {
    const Sim sim = device.sim.value_or(Sim{});
    options.ramp_s = place.guard.ramp_s;
    options.substeps = sim.substeps;
    options.seed = sim.seed;
    add_axes(compilation, place, sim, options);
    add_linkage(compilation, place, sim, options);
    add_hand(compilation, place, sim.hand, options);
    add_failures(compilation, place, sim, options);
    add_digital(compilation, place, sim, options);
    add_force_sensor(compilation, place, sim, options);
  }
  compilation.simulated.push_back(std::move(options));
}

}  // namespace hapticd::config
