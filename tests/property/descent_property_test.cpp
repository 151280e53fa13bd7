// Theorem A and A' over random scenes of every kind: with S the energy that is stored,
//
//   -F_k.(x_{k+1} - x_k) >= S_{k+1} - S_k - 1/2 |x_{k+1} - x_k|^2_Q,   F the force on the contact,
//
// Q = K + 2 B/T through a coupling; rendered directly the sum of the touched bodies' stiffnesses.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "control/scene/solve.h"
#include "control/scene/visit.h"
#include "tests/support/meshes.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::test {
namespace {

using control::Free;
using control::ObjectKind;

/// Random numbers of one case; rapidcheck gives the seed.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double logarithmic(double low, double high) {
    return std::exp(uniform(std::log(low), std::log(high)));
  }
  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(engine_); }
  Vec3 point(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }
  Vec3 direction() {
    for (;;) {
      const Vec3 v = point(1);
      if (norm(v) > 0.1) return (1 / norm(v)) * v;
    }
  }
  Mat3 rotation() {
    const Vec3 a = direction();
    Vec3 b = cross(a, direction());
    while (!(norm(b) > 0.1)) b = cross(a, direction());
    b = (1 / norm(b)) * b;
    return {{{a, b, cross(a, b)}}};
  }

 private:
  std::mt19937_64 engine_;
};

control::Surface random_surface(Dice& dice, bool may_be_rigid) {
  const bool is_rigid = may_be_rigid && dice.below(3) == 0;
  const double dynamic = dice.below(2) == 0 ? 0 : dice.uniform(0, 1.2);
  const double fixed = dynamic == 0 ? 0 : dynamic * dice.uniform(1, 2);
  if (is_rigid) return rigid(fixed, dynamic);
  const double damping = may_be_rigid && dice.below(3) == 0 ? dice.logarithmic(0.01, 10) : 0;
  return surface(dice.logarithmic(10, 1e6), damping, fixed, dynamic);
}

void add_body(build::ProgramSpec& spec, Dice& dice, const control::Surface& surface,
              bool guides = true) {
  const Free side = dice.below(4) == 0 ? Free::inside : Free::outside;
  const double size = side == Free::inside ? 3 : 1;
  switch (dice.below(guides ? 8 : 7)) {
    case 0:
      add_object(spec, spec.free_planes, ObjectKind::plane,
                 control::Plane{dice.direction(), dice.uniform(-0.05, 0.02)}, surface);
      break;
    case 1:
      add_object(spec, spec.boxes, ObjectKind::box,
                 control::Box{{dice.rotation(), dice.point(0.05)},
                              size * Vec3{dice.uniform(0.005, 0.05), dice.uniform(0.005, 0.05),
                                          dice.uniform(0.005, 0.05)},
                              side},
                 surface);
      break;
    case 2:
      add_object(spec, spec.spheres, ObjectKind::sphere,
                 control::Sphere{dice.point(0.05), size * dice.uniform(0.005, 0.05), side},
                 surface);
      break;
    case 3:
      add_object(
          spec, spec.cylinders, ObjectKind::cylinder,
          control::Cylinder{dice.point(0.05), dice.direction(), size * dice.uniform(0.005, 0.04),
                            size * dice.uniform(0.005, 0.05), side},
          surface);
      break;
    case 4:
      add_object(spec, spec.capsules, ObjectKind::capsule,
                 control::Capsule{dice.point(0.05), dice.direction(),
                                  size * dice.uniform(0.005, 0.04), dice.uniform(0, 0.05), side},
                 surface);
      break;
    case 6: {  // bumps and hollows
      const double bumps = dice.uniform(0, 0.3), r = dice.uniform(0.01, 0.06);
      spec.encounters.push_back({.kind = ObjectKind::mesh,
                                 .shape = static_cast<std::uint32_t>(spec.meshes.size()),
                                 .surface = surface});
      const auto radius = [&](double theta, double phi) {
        return r * (1 + bumps * std::sin(3 * theta) * std::sin(4 * phi));
      };
      spec.meshes.push_back(
          std::make_shared<const build::MeshData>(build::make_mesh(globe(16, 9, radius)).value()));
      break;
    }
    case 7:
      add_object(spec, spec.line_guides, ObjectKind::line,
                 control::LineGuide{dice.point(0.05), dice.direction(), dice.uniform(0.01, 0.1),
                                    dice.uniform(0.002, 0.1)},
                 surface);
      break;
    default:
      add_object(
          spec, spec.reliefs, ObjectKind::relief,
          [&] {
            const Mat3 r = dice.rotation();
            return control::Relief{.normal = r.row[0],
                                   .along = r.row[1],
                                   .offset = dice.uniform(-0.05, 0),
                                   .amplitude = dice.uniform(0.0001, 0.002),
                                   .wavelength = dice.uniform(0.002, 0.02),
                                   .profile = dice.below(2) == 0
                                                  ? control::Relief::Profile::sinusoid
                                                  : control::Relief::Profile::groove};
          }(),
          surface);
  }
}

void add_field(build::ProgramSpec& spec, Dice& dice) {
  switch (dice.below(4)) {
    case 0:
      add_object(spec, spec.magnets, ObjectKind::magnet,
                 control::Magnet{dice.point(0.05), dice.uniform(0, 0.02), dice.uniform(0.005, 0.05),
                                 dice.uniform(0, 5)});
      break;
    case 1:
      add_object(spec, spec.detents, ObjectKind::detents,
                 control::Detents{dice.direction(), dice.uniform(-0.01, 0.01),
                                  dice.uniform(0.002, 0.03), dice.uniform(0, 3), 0});
      break;
    case 2:
      add_object(
          spec, spec.constant_fields, ObjectKind::constant,
          control::ConstantField{{dice.point(0.05), dice.uniform(0.02, 0.1)}, dice.point(3)});
      break;
    default:
      add_object(
          spec, spec.viscous_fields, ObjectKind::viscous,
          control::ViscousField{{dice.point(0.05), dice.uniform(0.02, 0.1)}, dice.uniform(0, 10)});
  }
}

/// A hand's way: smooth with jerks, some of them large against the objects.
class Way {
 public:
  explicit Way(Dice& dice) : dice_(dice), speed_(dice.logarithmic(1e-5, 5e-3)) {}
  Vec3 next() {
    velocity_ = 0.9 * velocity_ + dice_.point(0.4 * speed_);
    if (dice_.below(100) == 0) velocity_ = dice_.point(5 * speed_);
    at_ += velocity_;
    if (norm(at_) > 0.08) velocity_ = -0.05 * at_;
    return at_;
  }

 private:
  Dice& dice_;
  double speed_;
  Vec3 at_{0.02, 0.02, 0.02}, velocity_{};
};

/// Energy of the damper's last step: (1/2T) |d_k - d_{k-1}|^2_B.
double damper_energy(const control::Plan& plan, const std::vector<double>& memory,
                     const std::vector<double>& before) {
  if (plan.groups.empty() || memory.empty()) return 0;
  const control::GroupPlan& group = plan.groups[0];
  double sum = 0;
  for (std::size_t i = 0; i < group.memory; ++i) {
    for (std::size_t j = 0; j < group.memory; ++j) {
      sum += (memory[i] - before[i]) * plan.gains[group.damping.offset + i * group.memory + j] *
             (memory[j] - before[j]);
    }
  }
  return 0.5 * sum / plan.period_s;
}

double quadratic(const Mat3& q, const Vec3& v) {
  return dot(v, q * v);
}

/// What a guide holds where it lets go [J]: energies near it are differences of this.
double guide_energy(const build::ProgramSpec& spec) {
  double sum = 0;
  for (const control::Encounter& e : spec.encounters) {
    if (e.kind != ObjectKind::line) continue;
    const double range = spec.line_guides[e.shape].range;
    sum += 0.5 * range * range / e.surface.compliance;
  }
  return sum;
}

/// Runs the way; the smallest slack of the inequality, relative to the energies in it.
double least_slack(build::ProgramSpec spec, const Mat3& q, Dice& dice, int ticks) {
  const double offset = guide_energy(spec) + 1e-12;
  SceneRig rig(std::move(spec));
  const control::Plan& plan = rig.program.plan();
  control::State& state = rig.program.state();
  Way way(dice);
  Vec3 x = way.next();
  rig.start(x);
  const auto remembered = [&] {
    return std::vector<double>(state.coupling_memory.begin(), state.coupling_memory.end());
  };
  const auto stored = [&] { return control::stored_energy(plan, state, plan.contacts[0]); };
  std::vector<double> memory = remembered();
  Vec3 force = rig.at(x);
  double energy = stored() + damper_energy(plan, remembered(), memory);
  memory = remembered();
  double least = 0;
  for (int i = 0; i < ticks; ++i) {
    const Vec3 next = way.next();
    const Vec3 moved = next - x;
    const Vec3 before = force;
    force = rig.at(next);
    const std::vector<double> now = remembered();
    const double energy_now = stored() + damper_energy(plan, now, memory);
    const double work = -dot(before, moved);
    const double bound = energy_now - energy - 0.5 * quadratic(q, moved);
    const double scale = std::abs(work) + std::abs(energy_now) + std::abs(energy) +
                         0.5 * quadratic(q, moved) + offset;
    least = std::min(least, (work - bound) / scale);
    memory = now;
    energy = energy_now;
    x = next;
  }
  return least;
}

struct Coupled {
  build::ProgramSpec spec;
  Mat3 q;
};

/// `wells`: guides that let go and fields too, which store less than nothing where they pull.
Coupled coupled_scene(Dice& dice, bool with_damper, bool wells) {
  Coupled made{scene_spec(1, dice.below(3) == 0 ? dice.uniform(0.5, 10) : 1e9), {}};
  made.spec.period_s = dice.logarithmic(1e-4, 1e-2);
  const Mat3 r = dice.rotation();
  build::CouplingBlock block;
  block.coordinates = {0, 1, 2};
  block.stiffness = block.damping = {3, 3, std::vector<double>(9, 0.0)};
  for (std::size_t a = 0; a < 3; ++a) {
    const double k = dice.logarithmic(0.1, 1e4);
    const double b = with_damper ? dice.logarithmic(1e-3, 10) : 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j) {
        block.stiffness(i, j) += k * r.row[a][i] * r.row[a][j];
        block.damping(i, j) += b * r.row[a][i] * r.row[a][j];
      }
    }
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      block.stiffness(i, j) = block.stiffness(j, i);
      block.damping(i, j) = block.damping(j, i);
    }
    for (std::size_t j = 0; j < 3; ++j)
      made.q.row[i][j] = block.stiffness(i, j) + 2 * block.damping(i, j) / made.spec.period_s;
  }
  made.spec.coupling = {block};
  const std::array<std::uint16_t, 5> caps{0, 1, 2, 5, 50};
  made.spec.max_sweeps = caps[static_cast<std::size_t>(dice.below(5))];
  for (int i = 1 + dice.below(4); i > 0; --i)
    add_body(made.spec, dice, random_surface(dice, true), wells);
  for (int i = wells ? dice.below(3) : 0; i > 0; --i) add_field(made.spec, dice);
  return made;
}

RC_GTEST_PROP(TheoremA, HoldsForAnySceneThroughACoupling, (std::uint64_t seed)) {
  Dice dice(seed);
  Coupled scene = coupled_scene(dice, dice.below(2) == 0, true);
  const double least = least_slack(std::move(scene.spec), scene.q, dice, 300);
  RC_LOG() << "least slack " << least;
  RC_ASSERT(least >= -1e-9);
}

RC_GTEST_PROP(TheoremA, HoldsForAnySceneThatIsRenderedDirectly, (std::uint64_t seed)) {
  Dice dice(seed);
  build::ProgramSpec spec = scene_spec();
  spec.period_s = dice.logarithmic(1e-4, 1e-2);
  double sum = 0;
  for (int i = 1 + dice.below(3); i > 0; --i) {
    const control::Surface surface = random_surface(dice, false);
    sum += 1 / surface.compliance;
    add_body(spec, dice, surface);
  }
  const double least = least_slack(std::move(spec), diagonal(sum), dice, 300);
  RC_LOG() << "least slack " << least;
  RC_ASSERT(least >= -1e-9);
}

/// Theorem A' at its bound: a device whose damping is s K with the least s that the theorem allows.
/// Over every tick the force acts late by tau; what it takes from the hand, less the worst that
/// happens between the samples, plus what the damping takes, never sums up to less than nothing.
RC_GTEST_PROP(TheoremA, HoldsUnderLatencyWithTheSharperCheck, (std::uint64_t seed)) {
  Dice dice(seed);
  Coupled scene = coupled_scene(dice, false, false);
  const double period = scene.spec.period_s, tau = dice.uniform(0.01, 1) * period;
  const double p = 0.5 * period + 1.5 * tau;
  const double s = 0.5 * (p + std::sqrt(p * p + 2 * tau * (period - tau)));
  scene.spec.sharpen = {tau / period + tau * (period - tau) / (s * period)};
  scene.spec.contacts[0].max_force = 1e9;
  SceneRig rig(std::move(scene.spec));
  const control::ContactPlan& contact = rig.program.plan().contacts[0];
  Way way(dice);
  Vec3 x = way.next();
  rig.start(x);
  Vec3 force = rig.at(x), last = force;
  const double at_start = control::stored_energy(rig.program.plan(), rig.program.state(), contact);
  double taken = 0, moved_most = 0, lowest = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 next = way.next(), moved = next - x, change = force - last;
    const double damped = s / period * quadratic(scene.q, moved);
    const double between = 0.25 * tau * (period - tau) / (period * s) *
                           dot(change, control::solve_on(contact, scene.q, change));
    const Vec3 held = (1 - tau / period) * force + (tau / period) * last;
    taken += -dot(held, moved) - between + damped;
    lowest = std::min(lowest, taken);
    moved_most += damped + std::abs(dot(held, moved)) + between;
    last = force;
    force = rig.at(next);
    x = next;
  }
  RC_LOG() << "taken at least " << lowest << " of " << moved_most << ", stored " << at_start;
  RC_ASSERT(lowest >= -std::max(0.0, at_start) - 1e-9 * moved_most);
}

}  // namespace
}  // namespace hapticd::test
