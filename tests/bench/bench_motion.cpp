// What velocity estimators, observers and compensations cost an axis: step() on four devices of
// three axes that move along a stored path, with one of them on every axis, against none.
//
//   bench_motion                 ns per tick and per axis, medians of 15 repetitions; subtract "none"
//   bench_motion loop NAME TICKS so many ticks and nothing else: valgrind counts its instructions
#include <benchmark/benchmark.h>
#include <sys/utsname.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "control/build/filters.h"
#include "control/build/program.h"
#include "control/core/flush_denormals.h"
#include "control/step.h"

namespace {

using namespace hapticd;
using build::ObserverMode;
using build::ProgramSpec;

constexpr std::uint16_t kDevices = 4, kAxesPerDevice = 3, kAxes = kDevices * kAxesPerDevice;
constexpr double kPeriod_s = 1e-3;
constexpr double kCount_m = 1e-6;

using Add = std::function<void(ProgramSpec&, std::uint16_t axis)>;

Add observer(ObserverMode mode, int order) {
  return [=](ProgramSpec& spec, std::uint16_t axis) {
    spec.axis_observers.push_back(
        build::observer(axis, axis / kAxesPerDevice,
                        {.mode = mode,
                         .nominal_mass_kg = 0.1,
                         .nominal_damping_Ns_m = 0.2,
                         .mass_kg = mode == ObserverMode::model ? 0.11 : 0,
                         .cutoff_Hz = 10,
                         .order = order,
                         .max_output = 1},
                        kPeriod_s));
  };
}

Add fit(std::uint16_t window, std::uint16_t degree) {
  return [=](ProgramSpec& spec, std::uint16_t axis) {
    spec.least_squares.push_back(build::least_squares(axis, window, degree, kPeriod_s));
  };
}

void add_low_pass(ProgramSpec& spec, std::uint16_t axis) {
  spec.low_passes.push_back(build::low_pass(axis, 200, kPeriod_s));
}

void add_sensor(ProgramSpec& spec, std::uint16_t axis) {
  if (axis % kAxesPerDevice != 0) return;
  spec.force_sensors.push_back({.device = static_cast<std::uint16_t>(axis / kAxesPerDevice),
                                .channels = 3,
                                .turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}});
}

const std::map<std::string, Add>& variants() {
  static const std::map<std::string, Add> all = {
      {"none", [](ProgramSpec&, std::uint16_t) {}},
      {"low_pass", add_low_pass},
      {"least_squares_8", fit(8, 2)},
      {"least_squares_16", fit(16, 2)},
      {"foaw_17",
       [](auto& spec, auto axis) { spec.foaws.push_back(build::foaw(axis, 17, kCount_m)); }},
      {"alpha_beta_gamma",
       [](auto& spec, auto axis) {
         spec.alpha_beta_gammas.push_back(build::alpha_beta_gamma(axis, 800, kPeriod_s));
       }},
      {"model_1", observer(ObserverMode::model, 1)},
      {"model_2", observer(ObserverMode::model, 2)},
      {"classic_1", observer(ObserverMode::classic, 1)},
      {"classic_2", observer(ObserverMode::classic, 2)},
      {"sensor_2",
       [](auto& spec, auto axis) {
         add_sensor(spec, axis);
         observer(ObserverMode::sensor, 2)(spec, axis);
       }},
      {"classic_2_and_low_pass",
       [](auto& spec, auto axis) {
         add_low_pass(spec, axis);
         observer(ObserverMode::classic, 2)(spec, axis);
       }},
      {"friction",
       [](auto& spec, auto axis) {
         spec.frictions.push_back({axis, 0.1, 0.2, 0.01});
       }},
  };
  return all;
}

ProgramSpec spec_of(const Add& add) {
  ProgramSpec spec;
  spec.axes.assign(kAxes, {.unit_per_raw = kCount_m,
                           .modulus_raw = 4294967296.0,
                           .max_effort = 12,
                           .max_velocity = 2,
                           .max_step = 0.02});
  for (std::uint16_t d = 0; d < kDevices; ++d) {
    const auto first = static_cast<std::uint16_t>(d * kAxesPerDevice);
    spec.devices.push_back({.first_axis = first,
                            .axes = kAxesPerDevice,
                            .first_coordinate = first,
                            .coordinates = kAxesPerDevice,
                            .max_force = 10,
                            .max_slew = 5,
                            .ramp_per_tick = 0.01,
                            .max_stale_ticks = 3});
  }
  for (std::uint16_t axis = 0; axis < kAxes; ++axis) add(spec, axis);
  return spec;
}

class Axes {
 public:
  explicit Axes(const Add& add) : program_(spec_of(add)) {
    for (std::size_t i = 0; i < kPath; ++i) {
      const double turn = 2 * M_PI * static_cast<double>(i) / kPath;
      path_[i] = std::floor(5000 * std::sin(turn)) + 1e6;
    }
    input_.axes = samples_;
    input_.aux = aux_;
    input_.delivered = delivered_;
    input_.enable = true;
    for (int i = 0; i < 2000; ++i) tick();
  }

  void tick() {
    const double raw = path_[static_cast<std::size_t>(input_.tick++) % kPath];
    for (AxisSample& sample : samples_) sample = {.raw = raw, .freshness = Freshness::fresh};
    const control::TickOutput output = control::step(program_.plan(), program_.state(), input_);
    std::copy(output.effort.begin(), output.effort.end(), delivered_.begin());
    enabled_ = output.mode == control::Mode::enabled;
  }
  bool enabled() const { return enabled_; }

 private:
  static constexpr std::size_t kPath = 1024;
  FlushDenormals flush_denormals_;
  build::Program program_;
  std::array<double, kPath> path_{};
  std::vector<AxisSample> samples_{kAxes};
  std::vector<Aux> aux_{kDevices};
  std::vector<double> delivered_ = std::vector<double>(kAxes);
  control::TickInput input_;
  bool enabled_ = false;
};

void run(benchmark::State& state, const Add& add) {
  Axes axes(add);
  for (auto _ : state) axes.tick();
  state.counters["per_axis"] = benchmark::Counter(
      kAxes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  if (!axes.enabled()) state.SkipWithError("forces went off: not the figure of a working tick");
}

int loop(const std::string& name, long ticks) {
  const auto found = variants().find(name);
  if (found == variants().end()) {
    std::fprintf(stderr, "bench_motion: no variant '%s'; there are:", name.c_str());
    for (const auto& [known, add] : variants()) std::fprintf(stderr, " %s", known.c_str());
    std::fprintf(stderr, "\n");
    return 64;
  }
  Axes axes(found->second);
  for (long i = 0; i < ticks; ++i) axes.tick();
  return axes.enabled() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4 && std::string(argv[1]) == "loop") return loop(argv[2], std::atol(argv[3]));
  utsname name{};
  uname(&name);
  benchmark::AddCustomContext("kernel", std::string(name.release) + " " + name.machine);
  for (const auto& [label, add] : variants()) {
    benchmark::RegisterBenchmark(label.c_str(), run, add)->Repetitions(15)->ReportAggregatesOnly();
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 64;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
