// A simulated axis being identified: what the verb does, without files and progress.
#pragma once
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "control/identify/response.h"
#include "control/identify/runner.h"
#include "sim/sim_device.h"

namespace hapticd::test {

/// A 15-bit encoder over 0.2 m.
inline constexpr double kCountsPerM = 32768 / 0.2;

inline sim::DeviceOptions bench_axis(const sim::AxisOptions& axis, std::uint64_t seed = 1) {
  sim::DeviceOptions device;
  device.name = "bench";
  device.seed = seed;
  device.axes = {axis};
  device.axes[0].counts_per_m = kCountsPerM;
  device.axes[0].encoder_bits = 15;
  device.axes[0].position_m = 0.1;  // the middle: it never wraps
  return device;
}

inline identify::ExcitationOptions bench_excitation(identify::Method method) {
  return {.method = method,
          .low_Hz = 2,
          .high_Hz = 50,
          .steps = 8,
          .blocks = 3,
          .sweeps = 4,
          .sweep_s = 2.5,
          .force = 3,
          .travel = 0.03,
          .speed = 0.75};
}

/// What a run left behind.
struct BenchRun {
  identify::Runner runner;
  identify::Signal hand_force;
  double greatest_effort = 0;
  double greatest_step = 0;       ///< of the effort, from tick to tick
  double greatest_deviation = 0;  ///< of the true position from where it began
  double greatest_speed = 0;      ///< true
};

/// `missing(tick)`: the sample of that tick is lost.
template <class Missing>
BenchRun run_bench(const sim::DeviceOptions& options, const identify::ExcitationOptions& excitation,
                   Missing missing) {
  sim::SimDevice device(options);
  if (!device.connect()) std::abort();
  device.set_armed(true);
  BenchRun run{.runner = identify::Runner(excitation, options.period_s), .hand_force = {}};
  AxisSample sample;
  Aux aux;
  double before = 0;
  for (std::int64_t tick = 0; run.runner.ended() == identify::Ended::running; ++tick) {
    device.request({.tick = tick, .start_ns = tick * 1'000'000, .deadline_ns = 0});
    device.collect({&sample, 1}, aux);
    const double position = sample.raw / options.axes[0].counts_per_m;
    double effort = run.runner.tick(position, !missing(tick));
    double delivered = 0;
    device.command({&effort, 1}, {&delivered, 1});
    run.runner.delivered(delivered);
    run.hand_force.push_back(aux.analogue[0]);
    run.greatest_effort = std::max(run.greatest_effort, std::abs(effort));
    run.greatest_step = std::max(run.greatest_step, std::abs(effort - before));
    before = effort;
    const sim::Truth& truth = device.truth(0);
    run.greatest_deviation =
        std::max(run.greatest_deviation, std::abs(truth.position_m - options.axes[0].position_m));
    run.greatest_speed = std::max(run.greatest_speed, std::abs(truth.velocity_m_s));
  }
  return run;
}

inline BenchRun run_bench(const sim::DeviceOptions& options,
                          const identify::ExcitationOptions& excitation) {
  return run_bench(options, excitation, [](std::int64_t) { return false; });
}

/// Uniform numbers that are the same on every machine.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  /// By equal chances for equal ratios.
  double around(double middle, double ratio) {
    return middle * std::exp(between(-1, 1) * std::log(ratio));
  }

 private:
  std::mt19937_64 engine_;
};

/// An axis of any kind within reason; the delay is no whole number of anything.
inline sim::AxisOptions any_axis(std::uint64_t seed) {
  Draw draw(seed);
  return {.mass_kg = draw.around(0.05, 2),
          .damping_Ns_m = draw.around(1, 2.5),
          .coulomb_N = draw.between(0.05, 0.4),
          .delay_s = draw.between(0, 2.5e-3),
          .noise_counts = draw.between(0.3, 1.2),
          .max_effort_N = 8};
}

}  // namespace hapticd::test
