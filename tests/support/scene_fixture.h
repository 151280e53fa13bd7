// Scenes for tests, without YAML: devices whose contacts are put anywhere, and the force that the
// scene answers.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "control/build/program.h"
#include "control/scene/render.h"
#include "control/step.h"

namespace hapticd::test {

/// `devices` devices of three axes each along x, y, z; `max_force` per contact.
inline build::ProgramSpec scene_spec(std::size_t devices = 1, double max_force = 1e9) {
  build::ProgramSpec spec;
  for (std::size_t d = 0; d < devices; ++d) {
    const auto first = static_cast<std::uint16_t>(3 * d);
    std::string name("d");  // not "d" + ...: GCC 12's bug 105651
    name += std::to_string(d);
    spec.devices.push_back({.first_axis = first,
                            .axes = 3,
                            .first_coordinate = first,
                            .coordinates = 3,
                            .max_force = max_force,
                            .max_slew = 1e9,
                            .ramp_per_tick = 1,
                            .max_stale_ticks = 3});
    spec.device_names.push_back(name);
    for (std::size_t i = 0; i < 3; ++i) {
      spec.axes.push_back({.max_effort = 1e9, .max_velocity = 1e9, .max_step = 1e9});
      spec.axis_names.push_back(name + "." + std::string(1, static_cast<char>('x' + i)));
      spec.coordinate_names.push_back(spec.axis_names.back());
    }
    spec.contacts.push_back({.device = static_cast<std::uint16_t>(d),
                             .first_coordinate = first,
                             .coordinates = 3,
                             .direction = {0, 1, 2},
                             .max_force = max_force});
  }
  return spec;
}

inline control::Surface surface(double stiffness, double damping = 0, double mu_static = 0,
                                double mu_dynamic = 0) {
  return {.compliance = 1 / stiffness,
          .damping = damping,
          .static_friction = mu_static,
          .dynamic_friction = mu_dynamic};
}

inline control::Surface rigid(double mu_static = 0, double mu_dynamic = 0) {
  return {.compliance = control::kRigidCompliance,
          .damping = 0,
          .static_friction = mu_static,
          .dynamic_friction = mu_dynamic};
}

/// One more object of `kind` in `shapes`, felt by `contact`.
template <class Shape>
control::Encounter& add_object(build::ProgramSpec& spec, std::vector<Shape>& shapes,
                               control::ObjectKind kind, const Shape& shape,
                               const control::Surface& surface = {}, std::uint16_t contact = 0) {
  spec.encounters.push_back({.kind = kind,
                             .contact = contact,
                             .shape = static_cast<std::uint32_t>(shapes.size()),
                             .surface = surface});
  shapes.push_back(shape);
  return spec.encounters.back();
}

/// Diagonal K and B over all three coordinates of a contact.
inline build::CouplingBlock spring_damper(std::uint32_t first_coordinate, Vec3 stiffness,
                                          Vec3 damping = {}) {
  build::CouplingBlock block;
  block.stiffness = block.damping = {3, 3, std::vector<double>(9, 0.0)};
  for (std::uint32_t i = 0; i < 3; ++i) {
    block.coordinates.push_back(first_coordinate + i);
    block.stiffness(i, i) = stiffness[i];
    block.damping(i, i) = damping[i];
  }
  return block;
}

/// Renders a scene with forces on.
class SceneRig {
 public:
  explicit SceneRig(build::ProgramSpec spec) : program(std::move(spec)) {}

  /// First tick of a run, forces still off: proxies start at their contacts.
  Vec3 start(const Vec3& x) {
    program.state().mode = control::Mode::idle;
    return at(x);
  }
  /// One tick with the first contact there; the force on it.
  Vec3 at(const Vec3& x) {
    put(0, x);
    return again();
  }
  void put(std::size_t contact, const Vec3& x) {
    control::State& state = program.state();
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t row = 3 * contact + i;
      state.v[row] = (x[i] - state.x[row]) / program.plan().period_s;
      state.x[row] = x[i];
    }
  }
  Vec3 again() {
    control::render(program.plan(), program.state(), input, findings);
    program.state().mode = control::Mode::enabled;
    ++input.tick;
    return force();
  }
  Vec3 force(std::size_t contact = 0) const {
    const auto f = program.state().scene_force.subspan(3 * contact, 3);
    return {f[0], f[1], f[2]};
  }
  Vec3 proxy(std::size_t contact = 0) const { return program.state().contacts[contact].proxy; }

  build::Program program;
  control::TickInput input;
  control::Findings findings;
};

}  // namespace hapticd::test
