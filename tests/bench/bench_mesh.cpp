// Contact with meshes: what a query and a whole tick cost, how far the force is from that of the
// ideal surface.
//
//   bench_mesh [short]     short: without the meshes of 200 000 triangles and more
//
// Workload: tests/support/meshes.h, probe(): a sphere and a bumpy sphere of 5 cm, 20 s of sliding
// at up to 0.15 m/s from 2 mm outside to 2 mm inside, 1 kN/m, a point and a ball of 5 mm. Force:
// k (proxy - contact), ideal force: k depth along the radius. "ideal N": k times the largest depth
// below the nearest point of the whole mesh; a peak above it means that the proxy stayed behind.
// "query" is nearest() alone, "tick" all of step() for one device of three axes.
#include <sys/utsname.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "tests/support/meshes.h"
#include "tests/support/program_fixture.h"

namespace {

using namespace hapticd;
using namespace hapticd::test;

constexpr double kStiffness_N_m = 1000;

std::int64_t now_ns() {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

struct Result {
  std::int64_t median_ns = 0, touching_ns = 0, p99_ns = 0, max_ns = 0;
  double rms_N = 0, worst_N = 0, peak_N = 0;
  double ideal_peak_N = 0;  ///< of the depth below the nearest point of the whole mesh
  int missed = 0;           ///< ticks deeper than the facets are high, and yet without force
};

std::int64_t quantile(std::vector<std::int64_t>& times, double share) {
  if (times.empty()) return 0;
  const auto at =
      times.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(times.size() - 1));
  std::nth_element(times.begin(), at, times.end());
  return *at;
}

using MeshPtr = std::shared_ptr<const build::MeshData>;

/// nearest() and nothing else.
class Query {
 public:
  Query(const MeshPtr& mesh, double radius_m) : probe_{.mesh = mesh->view(), .radius = radius_m} {}
  Vec3 force_N(const Vec3& x) { return kStiffness_N_m * probe_.at(x); }

 private:
  MeshProbe probe_;
};

/// The mesh as the only object of a device whose raw values are metres; no limit bites.
build::ProgramSpec spec_of_mesh(const MeshPtr& mesh, double radius_m) {
  build::ProgramSpec spec = spec_of(3);
  for (control::AxisPlan& axis : spec.axes)
    axis = {.max_effort = 1e3, .max_velocity = 1e3, .max_step = 1e3};
  spec.devices[0].max_force = spec.devices[0].max_slew = 1e3;
  spec.meshes = {mesh};
  spec.contacts = {{.coordinates = 3, .direction = {0, 1, 2}, .radius = radius_m}};
  spec.contacts[0].max_force = 1e3;
  spec.encounters = {{.kind = control::ObjectKind::mesh}};
  spec.encounters[0].surface.compliance = 1 / kStiffness_N_m;
  return spec;
}

class Tick {
 public:
  Tick(const MeshPtr& mesh, double radius_m) : rig_(spec_of_mesh(mesh, radius_m)) {
    rig_.input.enable = true;
    for (int i = 0; i < 20; ++i) force_N({1, 0, 0});
  }
  Vec3 force_N(const Vec3& x) {
    for (std::size_t i = 0; i < 3; ++i)
      rig_.samples[i] = {.raw = x[i], .freshness = Freshness::fresh};
    control::step(rig_.program.plan(), rig_.program.state(), rig_.input);
    ++rig_.input.tick;
    const auto& force = rig_.program.state().force;
    return {force[0], force[1], force[2]};
  }

 private:
  Rig rig_;
};

/// Depth below the ideal surface, straight towards the centre.
template <class Contact, class Radius>
Result run(const MeshPtr& mesh, double radius_m, Radius&& surface) {
  Result result;
  std::vector<std::int64_t> times, touching;
  std::vector<Vec3> path;
  for (int i = 0; i < kProbes; ++i) {
    const Probe p = probe(i);
    path.push_back((surface(p.theta, p.phi) + radius_m - p.depth) * direction(p.theta, p.phi));
  }
  double sum = 0;
  int contacts = 0;
  for (const bool timed : {false, true}) {
    const auto contact = std::make_unique<Contact>(mesh, radius_m);
    for (int i = 0; i < kProbes; ++i) {
      const std::int64_t start = now_ns();
      const Vec3 force_N = contact->force_N(path[static_cast<std::size_t>(i)]);
      const std::int64_t time = now_ns() - start;
      if (!timed) {
        const double height =
            control::nearest_surface(mesh->view(), path[static_cast<std::size_t>(i)], 1).height;
        result.ideal_peak_N = std::max(result.ideal_peak_N, kStiffness_N_m * (radius_m - height));
        continue;
      }
      const Probe p = probe(i);
      times.push_back(time);
      result.peak_N = std::max(result.peak_N, norm(force_N));
      if (p.depth <= 0) continue;
      touching.push_back(time);
      if (p.depth > 0.5e-3 && norm(force_N) == 0) ++result.missed;
      const Vec3 ideal_N = kStiffness_N_m * p.depth * direction(p.theta, p.phi);
      const double error = norm(force_N - ideal_N);
      sum += error * error;
      result.worst_N = std::max(result.worst_N, error);
      ++contacts;
    }
  }
  result.rms_N = std::sqrt(sum / contacts);
  result.max_ns = *std::max_element(times.begin(), times.end());
  result.median_ns = quantile(times, 0.5);
  result.p99_ns = quantile(times, 0.99);
  result.touching_ns = quantile(touching, 0.5);
  return result;
}

void print(const char* surface, const char* what, std::size_t triangles, double ball_m,
           const Result& r) {
  std::printf("%-7s %9zu %-5s %-5s %7lld %8lld %7lld %9lld %9.4f %8.4f %7.3f %7.3f %7d\n", surface,
              triangles, ball_m > 0 ? "ball" : "point", what, static_cast<long long>(r.median_ns),
              static_cast<long long>(r.touching_ns), static_cast<long long>(r.p99_ns),
              static_cast<long long>(r.max_ns), r.rms_N, r.worst_N, r.peak_N, r.ideal_peak_N,
              r.missed);
}

template <class Radius>
void report(const char* name, std::uint32_t nu, std::uint32_t nv, Radius&& surface) {
  const std::int64_t start = now_ns();
  auto made = build::make_mesh(globe(nu, nv, surface));
  if (!made) {
    std::fprintf(stderr, "%s: %s\n", name, made.error().text.c_str());
    return;
  }
  const auto mesh = std::make_shared<const build::MeshData>(std::move(*made));
  std::printf("built in %.0f ms\n", 1e-6 * static_cast<double>(now_ns() - start));
  for (const double ball_m : {0.0, 0.005}) {
    print(name, "query", mesh->triangles.size(), ball_m, run<Query>(mesh, ball_m, surface));
    print(name, "tick", mesh->triangles.size(), ball_m, run<Tick>(mesh, ball_m, surface));
  }
}

}  // namespace

int main(int argc, char** argv) {
  const bool brief = argc > 1 && std::strcmp(argv[1], "short") == 0;
  utsname name{};
  uname(&name);
  std::printf("%s %s; a clock read is in every time: %lld ns\n", name.release, name.machine, [] {
    const std::int64_t start = now_ns();
    for (int i = 0; i < 999; ++i) now_ns();
    return static_cast<long long>((now_ns() - start) / 1000);
  }());
  std::printf("%-7s %9s %-5s %-5s %7s %8s %7s %9s %9s %8s %7s %7s %7s\n", "surface", "triangles",
              "tool", "what", "median", "touching", "p99", "max ns", "rms N", "worst N", "peak N",
              "ideal N", "missed");
  const auto sphere = [](double, double) { return 0.05; };
  report("sphere", 32, 17, sphere);
  report("sphere", 100, 51, sphere);
  report("sphere", 316, 159, sphere);
  if (!brief) {
    report("sphere", 450, 226, sphere);
    report("sphere", 707, 355, sphere);
    report("sphere", 1000, 501, sphere);
  }
  report("bumpy", 100, 51, bumpy_radius);
  report("bumpy", 200, 101, bumpy_radius);
  report("bumpy", 316, 159, bumpy_radius);
  return 0;
}
