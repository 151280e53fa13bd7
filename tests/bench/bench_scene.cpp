// Whole ticks of one device with three axes, as bench_tick has them, in scenes of many objects of
// which one is touched, and behind couplings. (What each kind of object costs: bench_cost.)
//
//   bench_scene        medians of 15 repetitions; `build_ms` is what making the program took
#include <benchmark/benchmark.h>

#include <chrono>
#include <functional>

#include "tests/bench/tick_rig.h"

namespace hapticd::bench {
namespace {

using control::Free;
using control::ObjectKind;

// The contact swings by 5 mm along (1, 1, 1) through the origin.
const double kSlant = std::sqrt(1 / 3.0);
const Vec3 kWay{kSlant, kSlant, kSlant};

build::ProgramSpec scene() {
  build::ProgramSpec spec = tick_spec(1, 3, 0, false);
  spec.contacts = {{.coordinates = 3, .direction = {0, 1, 2}}};
  spec.contacts[0].max_force = 10;
  return spec;
}

void add(build::ProgramSpec& spec, ObjectKind kind, std::size_t shape) {
  control::Encounter made{.kind = kind, .shape = static_cast<std::uint32_t>(shape)};
  made.surface.compliance = 1e-3;
  spec.encounters.push_back(made);
}

void couple(build::ProgramSpec& spec, const Vec3& k, double b) {
  build::CouplingBlock block;
  block.coordinates = {0, 1, 2};
  block.stiffness = {3, 3, {k.x, 0, 0, 0, k.y, 0, 0, 0, k.z}};
  block.damping = {3, 3, {b, 0, 0, 0, b, 0, 0, 0, b}};
  spec.coupling = {block};
}

/// A sphere whose top the contact stays 5 to 15 mm below.
void add_touched_sphere(build::ProgramSpec& spec) {
  add(spec, ObjectKind::sphere, spec.spheres.size());
  spec.spheres.push_back({-0.04 * kWay, 0.05, Free::outside});
}

/// `count` spheres of 1 cm, one of them touched, the rest scattered in a cube of 10 m.
build::ProgramSpec many(std::size_t count) {
  build::ProgramSpec spec = scene();
  if (count > 0) add_touched_sphere(spec);
  for (std::size_t i = 1; i < count; ++i) {
    const auto at = [&](double stride) {
      return 10 * std::fmod(static_cast<double>(i) * stride, 1.0) - 5;
    };
    const Vec3 centre{at(0.8191725134), at(0.6710436067), at(0.5497004779)};
    if (norm(centre) < 0.1) continue;
    add(spec, ObjectKind::sphere, spec.spheres.size());
    spec.spheres.push_back({centre, 0.01, Free::outside});
  }
  return spec;
}

build::ProgramSpec coupled(const Vec3& k, double b, bool sphere, bool corner) {
  build::ProgramSpec spec = scene();
  couple(spec, k, b);
  if (sphere) add_touched_sphere(spec);
  for (std::size_t i = 0; corner && i < 3; ++i) {
    Vec3 normal;
    normal[i] = 1;
    add(spec, ObjectKind::plane, spec.free_planes.size());
    spec.free_planes.push_back({normal, 0.01});
  }
  return spec;
}

void run(benchmark::State& state, const std::function<build::ProgramSpec()>& make) {
  const auto before = std::chrono::steady_clock::now();
  TickRig rig(make());
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - before;
  for (auto _ : state) {
    rig.tick([]() noexcept -> std::int64_t { return 0; });
    benchmark::DoNotOptimize(rig.force());
  }
  state.counters["build_ms"] = took.count();
  if (!rig.enabled()) state.SkipWithError("forces went off");
}

void add_case(const char* name, std::function<build::ProgramSpec()> make) {
  benchmark::RegisterBenchmark(name, [make](benchmark::State& state) { run(state, make); })
      ->Repetitions(15)
      ->ReportAggregatesOnly();
}

}  // namespace
}  // namespace hapticd::bench

int main(int argc, char** argv) {
  using namespace hapticd::bench;
  const hapticd::Vec3 even{800, 800, 800}, uneven{400, 800, 1600};
  add_case("0 objects", [] { return many(0); });
  add_case("1 object", [] { return many(1); });
  add_case("100 objects", [] { return many(100); });
  add_case("1000 objects", [] { return many(1000); });
  add_case("10000 objects", [] { return many(10000); });
  add_case("coupling alone", [=] { return coupled(even, 0, false, false); });
  add_case("coupling with damper", [=] { return coupled(even, 0.1, false, false); });
  add_case("coupled sphere", [=] { return coupled(even, 0, true, false); });
  add_case("coupled sphere, uneven spring", [=] { return coupled(uneven, 0, true, false); });
  add_case("coupled corner of three planes", [=] { return coupled(even, 0, false, true); });
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 64;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
