// Programs for tests, without YAML: devices of Cartesian axes with 1e6 counts per metre.
#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "control/build/program.h"
#include "control/step.h"

namespace hapticd::test {

inline constexpr double kCountsPerMetre = 1e6;

/// One device of `axes` axes: 1 kHz, 10 N, 2 m/s, slew out of the way, ramp of eight ticks.
inline build::ProgramSpec spec_of(std::size_t axes) {
  build::ProgramSpec spec;
  const auto count = static_cast<std::uint16_t>(axes);
  spec.axes.assign(axes, {.unit_per_raw = 1 / kCountsPerMetre,
                          .modulus_raw = 4294967296.0,
                          .max_effort = 12,
                          .max_velocity = 2,
                          .max_step = 0.02});
  spec.devices = {{.axes = count,
                   .coordinates = count,
                   .max_force = 10,
                   .max_slew = 100,
                   .ramp_per_tick = 0.125,
                   .max_stale_ticks = 3}};
  spec.device_names = {"left"};
  for (std::size_t i = 0; i < axes; ++i) {
    spec.axis_names.push_back("left." + std::string(1, static_cast<char>('x' + i)));
    spec.coordinate_names.push_back(spec.axis_names.back());
  }
  return spec;
}

/// A wall at x = 0 whose free side is positive x.
inline control::PlaneContact wall(double stiffness, double damping, std::size_t coordinates = 1) {
  return {.coordinates = static_cast<std::uint16_t>(coordinates),
          .normal = {1, 0, 0},
          .stiffness = stiffness,
          .damping = damping};
}

/// Drives step() by positions in metres.
class Rig {
 public:
  explicit Rig(build::ProgramSpec spec)
      : program(std::move(spec)),
        samples(program.plan().axes.size()),
        aux(program.plan().devices.size()),
        delivered(program.plan().axes.size(), 0.0) {
    input.axes = samples;
    input.aux = aux;
    input.delivered = delivered;
  }

  /// One tick with the first axis at `position_m`; the others stay where they are.
  control::TickOutput at(double position_m) {
    samples[0].raw = raw(position_m);
    return again();
  }
  control::TickOutput again() {
    for (AxisSample& sample : samples) sample.freshness = Freshness::fresh;
    return run();
  }
  control::TickOutput run() {
    const control::TickOutput output = control::step(program.plan(), program.state(), input);
    delivered.assign(output.effort.begin(), output.effort.end());
    ++input.tick;
    input.clear_fault = false;
    return output;
  }
  /// Holds `position_m` with forces wanted until the ramp is through.
  control::TickOutput enable_at(double position_m) {
    at(position_m);
    input.enable = true;
    control::TickOutput output;
    for (int i = 0; i < 12; ++i) output = at(position_m);
    return output;
  }
  static double raw(double position_m) {
    const double counts = std::floor(position_m * kCountsPerMetre + 0.5);
    return counts < 0 ? counts + 4294967296.0 : counts;
  }

  build::Program program;
  std::vector<AxisSample> samples;
  std::vector<Aux> aux;
  std::vector<double> delivered;
  control::TickInput input;
};

}  // namespace hapticd::test
