// The truth of a simulated device. Nothing of it goes into the plan or the stability check.
#include <algorithm>
#include <cmath>

#include "config/compilation.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// The options of the simulator know no encoder offset: its position is the axis' position less the
/// offset, and a reversed encoder has negative counts per metre. So the loop gets the axis' own
/// position and sign back.
sim::AxisOptions axis_options(const Axis& axis, const SimAxis& truth) {
  const AxisModel model = axis.model.value_or(AxisModel{});
  return {.mass_kg = truth.mass_kg.value_or(model.mass_kg),
          .damping_Ns_m = truth.damping_Ns_m.value_or(model.damping_Ns_m),
          .coulomb_N = truth.coulomb_N,
          .delay_s = truth.delay_s,
          .position_m = truth.position_m - axis.encoder.offset_m,
          .counts_per_m = (axis.encoder.reversed ? -1 : 1) * axis.encoder.counts_per_m,
          .encoder_bits = axis.encoder.bits,
          .noise_counts = truth.noise_counts,
          .dac_step_N = truth.dac_step_N,
          .max_effort_N = axis.actuator.max_force_N};
}

void check_axis(Compilation& compilation, const std::string& path, const Axis& axis,
                const sim::AxisOptions& options) {
  if (!(options.mass_kg > 0)) {
    compilation.refuse(path + ".mass_kg", "no mass: give it here, or in the axis' model");
  }
  if (options.dac_step_N > options.max_effort_N) {
    compilation.refuse(path + ".dac_step_N", "expected at most actuator.max_force_N, " +
                                                 format_number(options.max_effort_N) +
                                                 " N, found " + format_number(options.dac_step_N) +
                                                 " N");
  }
  const double counts = std::abs(options.position_m * options.counts_per_m);
  if (axis.encoder.bits > 0 && counts >= std::ldexp(1.0, axis.encoder.bits - 1)) {
    compilation.refuse(path + ".position_m",
                       "the encoder of " + std::to_string(axis.encoder.bits) +
                           " bits wraps before it gets here; start nearer to encoder.offset_m");
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
  for (std::size_t i = 0; i < axes.size(); ++i) {
    options.axes.push_back(axis_options(axes[i], sim.axes.empty() ? SimAxis{} : sim.axes[i]));
    check_axis(compilation, indexed(path, i), axes[i], options.axes.back());
  }
}

/// One hand holds all axes, so where it wants to be is the same number on all; their encoders must
/// share one offset.
void add_hand(Compilation& compilation, const DevicePlace& place, const SimHand& hand,
              sim::DeviceOptions& options) {
  const std::string path = place.path + ".sim.hand.script";
  const double offset_m = place.device.axes.front().encoder.offset_m;
  const auto differs = [&](const Axis& axis) { return axis.encoder.offset_m != offset_m; };
  const std::vector<Axis>& axes = place.device.axes;
  if (hand.stiffness_N_m > 0 && !hand.script.empty() &&
      std::any_of(axes.begin(), axes.end(), differs)) {
    compilation.refuse(
        path,
        "a springy hand with a script needs the same encoder.offset_m on all axes of the device");
  }
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
        {.at_s = step.at_s, .force_N = step.force_N, .position_m = step.position_m - offset_m});
  }
}

void add_failures(Compilation& compilation, const DevicePlace& place, const Sim& sim,
                  sim::DeviceOptions& options) {
  std::vector<std::string> names;
  for (const Axis& axis : place.device.axes) names.push_back(axis.name);
  for (std::size_t i = 0; i < sim.failures.size(); ++i) {
    const SimFailure& failure = sim.failures[i];
    const auto axis =
        failure.axis ? std::find(names.begin(), names.end(), *failure.axis) : names.begin();
    if (axis == names.end()) {
      compilation.refuse(indexed(place.path + ".sim.failures", i) + ".axis",
                         unknown_name("axis", *failure.axis, names));
      continue;
    }
    // Both enumerations list the same kinds in the same order; a test holds them together.
    options.failures.push_back({.kind = static_cast<sim::FailureKind>(failure.kind),
                                .axis = static_cast<std::size_t>(axis - names.begin()),
                                .at_s = failure.at_s,
                                .for_s = failure.for_s,
                                .size_m = failure.size_m});
  }
}

}  // namespace

void compile_simulated(Compilation& compilation, const DevicePlace& place) {
  const Device& device = place.device;
  sim::DeviceOptions options;
  options.name = device.name;
  options.period_s = compilation.spec.period_s;
  if (device.driver == Driver::sim) {
    const Sim sim = device.sim.value_or(Sim{});
    options.ramp_s = place.guard.ramp_s;
    options.substeps = sim.substeps;
    options.seed = sim.seed;
    add_axes(compilation, place, sim, options);
    add_hand(compilation, place, sim.hand, options);
    add_failures(compilation, place, sim, options);
  } else if (device.sim) {
    compilation.refuse(place.path + ".sim",
                       "only a device with driver: sim has this key; remove it");
  }
  compilation.simulated.push_back(std::move(options));
}

}  // namespace hapticd::config
