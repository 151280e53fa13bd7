#include "sim/check_options.h"

#include <array>
#include <cmath>

#include "sim/check_linkage.h"
#include "sim/check_value.h"

namespace hapticd::sim {
namespace {

constexpr double kMaxDelayPeriods = 1000;  // the delay line is moved by one place a tick
constexpr int kMaxSubsteps = 10'000;
constexpr int kMaxEncoderBits = 52;  // counts stay exact in a double

std::string time_problem(const DeviceOptions& options) {
  if (!positive(options.period_s)) return expected("period_s", "a number > 0", options.period_s);
  if (options.substeps < 1 || options.substeps > kMaxSubsteps) {
    return expected("substeps", "1 to 10000", options.substeps);
  }
  return first_negative(std::array{Field{"ramp_s", options.ramp_s}});
}

std::string hand_problem(const HandOptions& hand) {
  const std::string problem = first_negative(std::array{
      Field{"hand mass_kg", hand.mass_kg}, Field{"hand stiffness_N_m", hand.stiffness_N_m},
      Field{"hand damping_Ns_m", hand.damping_Ns_m}});
  if (!problem.empty()) return problem;
  double last_s = 0;
  for (const ScriptStep& step : hand.script) {
    if (!(step.at_s >= last_s) || !std::isfinite(step.at_s)) {
      return expected("script at_s", "a time not before " + text(last_s), step.at_s);
    }
    if (!std::isfinite(step.force_N)) return expected("script force_N", "a number", step.force_N);
    if (!std::isfinite(step.position_m)) {
      return expected("script position_m", "a number", step.position_m);
    }
    last_s = step.at_s;
  }
  return {};
}

std::string axis_problem(const AxisOptions& axis, const DeviceOptions& options) {
  if (!positive(axis.mass_kg)) return expected("mass_kg", "a number > 0", axis.mass_kg);
  if (!positive(axis.max_effort_N))
    return expected("max_effort_N", "a number > 0", axis.max_effort_N);
  if (!std::isfinite(axis.counts_per_m) || axis.counts_per_m == 0) {
    return expected("counts_per_m", "a number other than 0", axis.counts_per_m);
  }
  if (axis.encoder_bits < 0 || axis.encoder_bits > kMaxEncoderBits) {
    return expected("encoder_bits", "0 to 52", axis.encoder_bits);
  }
  if (axis.delay_s > kMaxDelayPeriods * options.period_s) {
    return expected("delay_s", "at most 1000 periods", axis.delay_s);
  }
  const std::string problem = first_not_finite(
      std::array{Field{"position_m", axis.position_m}, Field{"zero_m", axis.zero_m},
                 Field{"index_m", axis.index_m.value_or(0)}});
  if (!problem.empty()) return problem;
  if (axis.stops) {
    const auto [min_m, max_m] = *axis.stops;
    if (!std::isfinite(min_m) || !std::isfinite(max_m) || min_m >= max_m) {
      return expected("stops max_m", "a number > min_m, which is " + text(min_m), max_m);
    }
    if (axis.position_m < min_m || axis.position_m > max_m) {
      return expected("position_m", "between the stops, " + text(min_m) + " to " + text(max_m),
                      axis.position_m);
    }
  }
  // A friction force held over a sub-step must slow the mass down, not swing it: sub-steps well
  // below the hand's period.
  const double swing =
      options.period_s / options.substeps *
      std::sqrt(options.hand.stiffness_N_m / (axis.mass_kg + options.hand.mass_kg));
  if (!options.linkage && axis.coulomb_N > 0 && swing > 0.5) {
    return expected(
        "substeps",
        "more, for this stiff hand with friction: each at most 0.5 sqrt(mass / stiffness)",
        options.substeps);
  }
  return first_negative(
      std::array{Field{"damping_Ns_m", axis.damping_Ns_m}, Field{"coulomb_N", axis.coulomb_N},
                 Field{"delay_s", axis.delay_s}, Field{"noise_counts", axis.noise_counts},
                 Field{"dac_step_N", axis.dac_step_N}, Field{"homed_at_s", axis.homed_at_s},
                 // Beyond it the amplifier could carry nothing at all.
                 Field{"max_effort_N less dac_step_N", axis.max_effort_N - axis.dac_step_N}});
}

std::string digital_problem(const std::vector<DigitalStep>& steps) {
  double last_s = 0;
  for (const DigitalStep& step : steps) {
    if (!(step.at_s >= last_s) || !std::isfinite(step.at_s)) {
      return expected("digital at_s", "a time not before " + text(last_s), step.at_s);
    }
    last_s = step.at_s;
  }
  return {};
}

std::string failure_problem(const Failure& failure, std::size_t axes) {
  if (failure.axis >= axes) {
    return expected("failure axis", "an axis of the device", static_cast<double>(failure.axis));
  }
  if (!std::isfinite(failure.size_m)) return expected("failure size_m", "a number", failure.size_m);
  return first_negative(
      std::array{Field{"failure at_s", failure.at_s}, Field{"failure for_s", failure.for_s}});
}

}  // namespace

std::string first_problem(const DeviceOptions& options) {
  std::string problem = time_problem(options);
  if (problem.empty() && options.axes.empty()) problem = expected("axes", "at least one", 0);
  if (problem.empty()) problem = hand_problem(options.hand);
  for (std::size_t i = 0; problem.empty() && i < options.axes.size(); ++i) {
    problem = axis_problem(options.axes[i], options);
    if (!problem.empty()) problem = "axis " + std::to_string(i) + ": " + problem;
  }
  for (std::size_t i = 0; problem.empty() && i < options.failures.size(); ++i) {
    problem = failure_problem(options.failures[i], options.axes.size());
  }
  if (problem.empty()) problem = digital_problem(options.digital);
  if (problem.empty() && options.force_sensor) {
    problem =
        first_negative(std::array{Field{"force_sensor noise_N", options.force_sensor->noise_N}});
  }
  if (problem.empty() && options.linkage) problem = linkage_problem(options);
  return problem;
}

}  // namespace hapticd::sim
