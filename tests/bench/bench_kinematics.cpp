// Forward kinematics of each kind of device alone, and of a whole plan with one of it: pose, turn
// into the world, velocity, condition. Joints follow a stored path at 1 kHz sampling.
#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "control/build/program.h"

namespace {

using namespace hapticd;
using Joints = std::array<double, kMaxJoints>;

constexpr std::size_t kPath = 1024;

control::LinearMap turned() {
  return {.columns = {{{0.6, -0.8, 0}, {0.8, 0.6, 0}, {0, 0, 1}}}};
}

control::FiveBar five_bar() {
  return {.link_m = 0.2, .base_m = 0.1};
}

control::Delta falcon() {
  const auto leg = [](double degrees) {
    return std::array{std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180)};
  };
  return {.a = 0.060,
          .b = 0.1025,
          .c = 0.01443,
          .d = 0.01125,
          .e = 0.01125,
          .f = -0.025,
          .r = 0.0400,
          .s = -0.02309,
          .leg = {leg(105), leg(-15), leg(-135)},
          .home = {0, 0, 0.11}};
}

control::Serial serial(std::uint16_t joints) {
  control::Serial chain{.joints = joints};
  for (std::size_t j = 0; j < joints; ++j) {
    const double twist = j % 2 == 0 ? 1.4 : -1.5;
    chain.joint[j] = {
        .d = 0.05, .a = 0.2, .cos_twist = std::cos(twist), .sin_twist = std::sin(twist)};
  }
  return chain;
}

/// Angles about `middle` that move by less than 1.3 mrad a tick.
std::vector<Joints> path_about(const Joints& middle) {
  std::vector<Joints> path(kPath, middle);
  for (std::size_t i = 0; i < kPath; ++i) {
    const double phase = 2 * M_PI * static_cast<double>(i) / kPath;
    for (std::size_t j = 0; j < kMaxJoints; ++j)
      path[i][j] += 0.2 * std::sin(phase + static_cast<double>(j));
  }
  return path;
}

constexpr Joints kFiveBarMiddle{2.253, 0.888};
constexpr Joints kFalconMiddle{0.5, 0.5, 0.5};
constexpr Joints kSerialMiddle{0.3, 0.6, -0.5, 0.4, 0.7, 0.2};

template <class Kind>
void pose(benchmark::State& state, const Kind& kind, const Joints& middle) {
  const std::vector<Joints> path = path_about(middle);
  control::LinkagePose at;
  std::size_t i = 0;
  bool fits = true;
  for (auto _ : state) {
    fits &= pose_of(kind, path[i++ % kPath].data(), at);
    benchmark::DoNotOptimize(at);
  }
  if (!fits) state.SkipWithError("a pose was not found: the figure would not be that of the path");
}

void add(build::ProgramSpec& spec, const control::LinearMap& map) {
  spec.linear_maps = {map};
}
void add(build::ProgramSpec& spec, const control::FiveBar& bars) {
  spec.five_bars = {bars};
}
void add(build::ProgramSpec& spec, const control::Delta& delta) {
  spec.deltas = {delta};
}
void add(build::ProgramSpec& spec, const control::Serial& chain) {
  spec.serials = {chain};
}

template <class Kind>
void forward(benchmark::State& state, const Kind& kind, const Joints& middle, std::uint16_t axes,
             std::uint16_t coordinates) {
  build::ProgramSpec spec;
  spec.axes.assign(axes, {.max_effort = 1});
  spec.devices = {{.axes = axes, .coordinates = coordinates}};
  control::Linkage linkage{.axes = axes, .coordinates = coordinates};
  for (std::size_t i = 0; i < 3; ++i) linkage.turn[i][i] = 1;
  spec.linkages = {linkage};
  add(spec, kind);
  build::Program program(std::move(spec));
  for (control::AxisState& axis : program.state().axes) axis.seeded = axis.homed = true;
  const std::vector<Joints> path = path_about(middle);
  control::Findings findings;
  std::size_t i = 0;
  for (auto _ : state) {
    std::copy_n(path[i++ % kPath].begin(), axes, program.state().q.begin());
    control::forward(program.plan(), program.state(), findings);
    benchmark::DoNotOptimize(program.state().x.data());
    benchmark::ClobberMemory();
  }
  if (findings.fault.code != Fault::none) state.SkipWithError("a pose was not found");
}

void settings(benchmark::internal::Benchmark* bench) {
  bench->Repetitions(15)->ReportAggregatesOnly();
}

BENCHMARK_CAPTURE(pose, linear_map, turned(), Joints{})->Apply(settings);
BENCHMARK_CAPTURE(pose, five_bar, five_bar(), kFiveBarMiddle)->Apply(settings);
BENCHMARK_CAPTURE(pose, delta, falcon(), kFalconMiddle)->Apply(settings);
BENCHMARK_CAPTURE(pose, serial_3, serial(3), kSerialMiddle)->Apply(settings);
BENCHMARK_CAPTURE(pose, serial_6, serial(6), kSerialMiddle)->Apply(settings);
BENCHMARK_CAPTURE(forward, linear_map, turned(), Joints{}, 3, 3)->Apply(settings);
BENCHMARK_CAPTURE(forward, five_bar, five_bar(), kFiveBarMiddle, 2, 2)->Apply(settings);
BENCHMARK_CAPTURE(forward, delta, falcon(), kFalconMiddle, 3, 3)->Apply(settings);
BENCHMARK_CAPTURE(forward, serial_3, serial(3), kSerialMiddle, 3, 3)->Apply(settings);
BENCHMARK_CAPTURE(forward, serial_6, serial(6), kSerialMiddle, 6, 3)->Apply(settings);

}  // namespace

BENCHMARK_MAIN();
