// Run time against error: every choice that rendering has, each held against a fine reference.
//
//   pareto > pareto.csv       ns: median of a rendered tick; errors: root mean square over the run
//   tests/bench/pareto.sh     the same, and its picture
//
// kind        one wall, 2 mm deep at most, rendered by each kind of solver; reference: closed form
// sweeps      three bodies behind an uneven spring; reference: sweeps until nothing moves
// integrator  paper 1's network, contacts on smooth paths; reference: exact, at 64 kHz
// mesh        a sphere of triangles; reference: the sphere
// rate        the same network by the loop's rate, backward Euler
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <memory>

#include "control/core/flush_denormals.h"
#include "tests/support/meshes.h"
#include "tests/support/scene_fixture.h"

namespace {

using namespace hapticd;
using namespace hapticd::test;
using control::Free;
using control::ObjectKind;

std::int64_t now_ns() {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

/// Where the contacts are at a time; three numbers each.
using Way = std::function<std::vector<double>(double time_s)>;

/// What a run gave: forces and proxies of every tick, and the median time of a tick.
struct Run {
  std::vector<std::vector<double>> force, proxy;
  double ns = 0;
};

void place(SceneRig& rig, const std::vector<double>& x) {
  for (std::size_t c = 0; 3 * c < x.size(); ++c) rig.put(c, {x[3 * c], x[3 * c + 1], x[3 * c + 2]});
}

Run run(const build::ProgramSpec& spec, const Way& way, double duration_s) {
  SceneRig rig(spec);
  const auto ticks = static_cast<std::size_t>(duration_s / spec.period_s + 0.5);
  Run result;
  std::vector<double> times;
  place(rig, way(0));
  rig.program.state().mode = control::Mode::idle;
  for (std::size_t i = 0; i < ticks; ++i) {
    place(rig, way(static_cast<double>(i) * spec.period_s));
    const std::int64_t start = now_ns();
    rig.again();
    times.push_back(static_cast<double>(now_ns() - start));
    const control::State& state = rig.program.state();
    result.force.emplace_back(state.scene_force.begin(), state.scene_force.end());
    std::vector<double> proxy;
    for (const control::ContactState& contact : state.contacts)
      proxy.insert(proxy.end(), {contact.proxy.x, contact.proxy.y, contact.proxy.z});
    result.proxy.push_back(std::move(proxy));
  }
  std::nth_element(times.begin(), times.begin() + times.size() / 2, times.end());
  result.ns = times[times.size() / 2];
  return result;
}

/// Root mean square distance; `stride`: every so many entries of `fine` is one of `found`.
double rms(const std::vector<std::vector<double>>& found,
           const std::vector<std::vector<double>>& fine, std::size_t stride = 1) {
  double sum = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    for (std::size_t c = 0; c < found[i].size(); ++c) {
      const double off = found[i][c] - fine[i * stride][c];
      sum += off * off;
    }
  }
  return std::sqrt(sum / static_cast<double>(found.size()));
}

/// "at most 5"
std::string with_number(const char* format, double number) {
  char text[48];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

void print(const char* study, const std::string& choice, double ns, double force_N,
           double position_m) {
  std::printf("%s,\"%s\",%.0f,%.6g,%.6g\n", study, choice.c_str(), ns, force_N, position_m);
}

// -- kind

constexpr double kStiffness = 1000;

std::vector<double> over_the_wall(double t) {
  return {0.02 * std::sin(2 * kPi * 0.31 * t), 0.02 * std::sin(2 * kPi * 0.43 * t),
          -0.002 * std::sin(2 * kPi * 0.5 * t)};
}

void wall_kind(const char* name, build::ProgramSpec spec, double stiffness) {
  const Run found = run(spec, over_the_wall, 20);
  Run ideal;
  for (std::size_t i = 0; i < found.force.size(); ++i) {
    const std::vector<double> x = over_the_wall(1e-3 * static_cast<double>(i));
    const double depth = std::max(0.0, -x[2]);
    ideal.force.push_back({0, 0, stiffness * depth});
    const double proxy = x[2] + (spec.coupling.empty() ? 0 : depth);
    ideal.proxy.push_back({x[0], x[1], proxy});
  }
  const bool knows_proxy = !spec.contacts.empty();
  print("kind", name, found.ns, rms(found.force, ideal.force),
        knows_proxy ? rms(found.proxy, ideal.proxy) : 0);
}

void wall_kinds() {
  build::ProgramSpec none = scene_spec();
  none.contacts.clear();
  none.planes = {{.coordinates = 3, .normal = {0, 0, 1}, .stiffness = kStiffness}};
  wall_kind("plane, direct", none, kStiffness);
  const control::Plane floor{{0, 0, 1}, 0};
  build::ProgramSpec body = scene_spec();
  add_object(body, body.free_planes, ObjectKind::plane, floor, surface(kStiffness));
  wall_kind("plane as body", body, kStiffness);
  build::ProgramSpec coupled = scene_spec();
  add_object(coupled, coupled.free_planes, ObjectKind::plane, floor, rigid());
  coupled.coupling = {spring_damper(0, {kStiffness, kStiffness, kStiffness})};
  wall_kind("rigid plane, coupling", coupled, kStiffness);
  build::ProgramSpec box = scene_spec();
  add_object(box, box.boxes, ObjectKind::box,
             control::Box{{diagonal(1), {0, 0, -0.05}}, {0.05, 0.05, 0.05}, Free::outside},
             surface(kStiffness));
  wall_kind("box", box, kStiffness);
  build::ProgramSpec mesh = scene_spec();
  mesh.meshes = {std::make_shared<const build::MeshData>(
      build::make_mesh(box_soup({-0.05, -0.05, -0.1}, {0.05, 0.05, 0})).value())};
  mesh.encounters = {{.kind = ObjectKind::mesh, .surface = surface(kStiffness)}};
  wall_kind("mesh of 12 triangles", mesh, kStiffness);
}

// -- sweeps

build::ProgramSpec crowded(std::uint16_t max_sweeps, double tolerance) {
  build::ProgramSpec spec = scene_spec();
  add_object(spec, spec.spheres, ObjectKind::sphere, control::Sphere{{}, 0.05, Free::outside},
             surface(3000));
  add_object(spec, spec.free_planes, ObjectKind::plane, control::Plane{{0.6, 0, 0.8}, 0.03},
             surface(2000));
  add_object(spec, spec.capsules, ObjectKind::capsule,
             control::Capsule{{0, 0.03, 0.04}, {1, 0, 0}, 0.02, 0.05, Free::outside}, rigid());
  spec.coupling = {spring_damper(0, {400, 900, 2000})};
  spec.max_sweeps = max_sweeps;
  spec.solver_tolerance = tolerance;
  return spec;
}

std::vector<double> through_the_crowd(double t) {
  return {0.02 * std::sin(2 * kPi * 0.31 * t), 0.015 * std::sin(2 * kPi * 0.43 * t),
          0.046 + 0.006 * std::sin(2 * kPi * 0.71 * t)};
}

void sweeps() {
  const Run fine = run(crowded(5000, 0), through_the_crowd, 10);
  for (const std::uint16_t cap : std::initializer_list<std::uint16_t>{1, 2, 3, 5, 10, 20, 50}) {
    const Run found = run(crowded(cap, 0), through_the_crowd, 10);
    print("sweeps", with_number("at most %.0f", cap), found.ns, rms(found.force, fine.force),
          rms(found.proxy, fine.proxy));
  }
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8, 1e-10, 1e-12}) {
    const Run found = run(crowded(50, tolerance), through_the_crowd, 10);
    print("sweeps", with_number("tolerance %.0e N", tolerance), found.ns,
          rms(found.force, fine.force), rms(found.proxy, fine.proxy));
  }
}

// -- integrator and rate

build::ProgramSpec star(build::Integrator integrator, std::size_t substeps, double rate_Hz) {
  using build::NetworkEnd;
  build::ProgramSpec spec = scene_spec();
  spec.period_s = 1 / rate_Hz;
  const NetworkEnd mass{.at = NetworkEnd::At::node, .index = 0};
  build::Network network{.nodes = {{.mass = 3}}, .elements = {{mass, {}, 2600, 0.5}}};
  const double k[] = {3800, 3500, 3300}, b[] = {0.1, 0.2, 0.3};
  for (std::uint32_t i = 0; i < 3; ++i)
    network.elements.push_back({{NetworkEnd::At::coordinate, i}, mass, k[i], b[i]});
  spec.networks = {network};
  spec.integrator = integrator;
  spec.network_substeps = substeps;
  return spec;
}

std::vector<double> smooth(double t) {
  const auto start = 1 - std::exp(-t * t / 0.01);  // no jump of velocity at the start
  return {0.003 * start * std::sin(2 * kPi * 3 * t), 0.002 * start * std::sin(2 * kPi * 7 * t),
          0.002 * start * std::sin(2 * kPi * 11 * t)};
}

void integrators() {
  constexpr double kFine_Hz = 64000, kDuration_s = 2;
  const Run fine = run(star(build::Integrator::exact, 1, kFine_Hz), smooth, kDuration_s);
  const auto report = [&](const char* study, const std::string& name, build::Integrator integrator,
                          std::size_t substeps, double rate_Hz) {
    const Run found = run(star(integrator, substeps, rate_Hz), smooth, kDuration_s);
    print(study, name, found.ns,
          rms(found.force, fine.force, static_cast<std::size_t>(kFine_Hz / rate_Hz)), 0);
  };
  for (const std::size_t substeps : std::initializer_list<std::size_t>{1, 2, 4, 8}) {
    const auto number = static_cast<double>(substeps);
    report("integrator", with_number("backward Euler in %.0f", number),
           build::Integrator::backward_euler, substeps, 1000);
    report("integrator", with_number("trapezoid in %.0f", number), build::Integrator::trapezoid,
           substeps, 1000);
  }
  report("integrator", "exact", build::Integrator::exact, 1, 1000);
  for (const double rate_Hz : {500.0, 1000.0, 2000.0, 4000.0, 8000.0})
    report("rate", with_number("%.0f Hz", rate_Hz), build::Integrator::backward_euler, 1, rate_Hz);
}

// -- mesh

void meshes() {
  const std::pair<std::uint32_t, std::uint32_t> sizes[] = {
      {32, 17}, {100, 51}, {316, 159}, {1000, 501}};
  const Way way = [](double t) {
    const Probe p = probe(static_cast<int>(std::lround(1000 * t)));
    const Vec3 x = (0.05 - p.depth) * direction(p.theta, p.phi);
    return std::vector<double>{x.x, x.y, x.z};
  };
  for (const auto& [nu, nv] : sizes) {
    build::ProgramSpec spec = scene_spec();
    spec.meshes = {
        std::make_shared<const build::MeshData>(build::make_mesh(sphere_soup(nu, nv)).value())};
    spec.encounters = {{.kind = ObjectKind::mesh, .surface = surface(kStiffness)}};
    const Run found = run(spec, way, 20);
    std::vector<std::vector<double>> touched, ideal;
    for (std::size_t i = 0; i < found.force.size(); ++i) {
      const Probe p = probe(static_cast<int>(i));
      if (p.depth <= 0) continue;
      const Vec3 force = kStiffness * p.depth * direction(p.theta, p.phi);
      touched.push_back(found.force[i]);
      ideal.push_back({force.x, force.y, force.z});
    }
    print("mesh", with_number("%.0f triangles", 2 * nu * (nv - 1)), found.ns, rms(touched, ideal),
          0);
  }
  build::ProgramSpec closed = scene_spec();
  add_object(closed, closed.spheres, ObjectKind::sphere, control::Sphere{{}, 0.05, Free::outside},
             surface(kStiffness));
  print("mesh", "sphere in closed form", run(closed, way, 20).ns, 0, 0);
}

}  // namespace

int main() {
  const hapticd::FlushDenormals flush_denormals;
  std::puts("study,choice,ns,rms_force_N,rms_position_m");
  wall_kinds();
  sweeps();
  integrators();
  meshes();
}
