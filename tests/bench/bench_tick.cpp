// Whole ticks: collect from and command to a device in memory, step, record push.
//
//   bench_tick                          medians of 15 repetitions
//   "no stamps"                         no clock is read inside: what the loop itself costs
//   "stamps"                            with the daemon's four clock reads a tick
#include <benchmark/benchmark.h>
#include <sys/utsname.h>
#include <time.h>

#include "tests/bench/tick_rig.h"

namespace {

using hapticd::bench::TickRig;

std::int64_t no_clock() noexcept {
  return 0;
}

std::int64_t monotonic_ns() noexcept {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void run(benchmark::State& state, hapticd::daemon::Now now) {
  TickRig rig(hapticd::bench::tick_spec(
      static_cast<std::size_t>(state.range(0)), static_cast<std::size_t>(state.range(1)),
      static_cast<std::size_t>(state.range(2)), state.range(3) != 0));
  for (auto _ : state) {
    rig.tick(now);
    benchmark::DoNotOptimize(rig.force());
  }
  if (!rig.enabled())
    state.SkipWithError("forces went off: the figure would not be that of a working tick");
}

void tick_no_stamps(benchmark::State& state) {
  run(state, no_clock);
}
void tick_stamps(benchmark::State& state) {
  run(state, monotonic_ns);
}

void settings(benchmark::internal::Benchmark* bench) {
  bench->ArgNames({"devices", "axes", "planes", "observed"})
      ->Repetitions(15)
      ->ReportAggregatesOnly();
}

BENCHMARK(tick_no_stamps)
    ->Apply(settings)
    ->Args({1, 3, 0, 0})
    ->Args({1, 3, 1, 0})
    ->Args({1, 3, 16, 0})
    ->Args({1, 1, 1, 0})
    ->Args({3, 3, 1, 0})
    ->Args({3, 3, 1, 1});
BENCHMARK(tick_stamps)->Apply(settings)->Args({1, 3, 0, 0})->Args({3, 3, 1, 1});

}  // namespace

int main(int argc, char** argv) {
  utsname name{};
  uname(&name);
  benchmark::AddCustomContext("kernel", std::string(name.release) + " " + name.machine);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 64;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
