// Every kind of object, coupling and network, on devices that a spec already has.
#pragma once
#include <limits>
#include <memory>

#include "tests/support/meshes.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::test {

namespace full_detail {

inline void add_contacts(build::ProgramSpec& spec) {
  for (std::size_t d = 0; d < spec.devices.size(); ++d) {
    const control::DevicePlan& device = spec.devices[d];
    spec.contacts.push_back({.device = static_cast<std::uint16_t>(d),
                             .first_coordinate = device.first_coordinate,
                             .coordinates = device.coordinates,
                             .direction = {0, 1, 2},
                             .radius = d == 1 ? 0.002 : 0,
                             .max_force = device.max_force});
  }
}

/// Bodies about the origin, where the contacts are, and one that moves.
inline void add_bodies(build::ProgramSpec& spec, std::uint16_t contact) {
  using control::Free;
  using control::ObjectKind;
  const control::Surface rough = surface(700, 0.1, 0.5, 0.3), smooth = surface(500);
  const double inf = std::numeric_limits<double>::infinity();
  const auto add = [&](auto& shapes, ObjectKind kind, const auto& shape,
                       const control::Surface& feel) -> control::Encounter& {
    return add_object(spec, shapes, kind, shape, feel, contact);
  };
  add(spec.free_planes, ObjectKind::plane, control::Plane{{0, 1, 0}, 0}, rough);
  add(spec.reliefs, ObjectKind::relief, control::Relief{{0, 0, 1}, {1, 0, 0}, 0, 0.001, 0.005},
      rough);
  add(spec.boxes, ObjectKind::box, control::Box{{}, {0.02, 0.03, 0.01}, Free::outside}, rough);
  add(spec.spheres, ObjectKind::sphere, control::Sphere{{}, 0.5, Free::inside}, smooth);
  add(spec.cylinders, ObjectKind::cylinder,
      control::Cylinder{{0.01, 0, 0}, {0, 0, 1}, 0.02, 0.03, Free::outside}, smooth);
  add(spec.capsules, ObjectKind::capsule,
      control::Capsule{{0, 0.01, 0}, {1, 0, 0}, 0.01, 0.02, Free::outside}, rough)
      .path = 0;
  add(spec.point_guides, ObjectKind::point, control::PointGuide{{0.01, 0, 0}, 0.05}, smooth);
  add(spec.line_guides, ObjectKind::line, control::LineGuide{{}, {0, 0, 1}, inf, inf}, smooth);
  add(spec.curve_guides, ObjectKind::curve, control::CurveGuide{0, 3, 0.1}, smooth);
  add(spec.viscous_fields, ObjectKind::viscous, control::ViscousField{{{}, 0.1}, 0.2}, {});
  add(spec.constant_fields, ObjectKind::constant, control::ConstantField{{{}, 0.1}, {0, 0, -1}},
      {});
  add(spec.detents, ObjectKind::detents, control::Detents{{1, 0, 0}, 0, 0.01, 0.5, 0}, {});
  add(spec.magnets, ObjectKind::magnet, control::Magnet{{0, 0, 0.01}, 0.005, 0.03, 0.5}, {});
  add(spec.vibrations, ObjectKind::vibration, control::Vibration{{{}, 0.1}, {0.1, 0, 0}, 60, 0},
      {});
  spec.encounters.push_back(
      {.kind = ObjectKind::mesh, .contact = contact, .shape = 0, .surface = rough});
}

inline build::CouplingBlock block(std::vector<std::uint32_t> coordinates, double stiffness,
                                  double damping, double tie = 0) {
  build::CouplingBlock made;
  made.coordinates = std::move(coordinates);
  const std::size_t size = made.coordinates.size();
  made.stiffness = made.damping = {size, size, std::vector<double>(size * size, 0.0)};
  for (std::size_t i = 0; i < size; ++i) {
    for (std::size_t j = 0; j < size; ++j) {
      made.stiffness(i, j) = i == j ? stiffness : tie;
      made.damping(i, j) = i == j ? damping : 0;
    }
  }
  return made;
}

/// d = V(z) (-f) of one coordinate: a lag of second order over a spring.
inline build::CouplingBlock general_block(std::uint32_t coordinate) {
  build::CouplingBlock made;
  made.coordinates = {coordinate};
  made.state_space = build::CouplingBlock::StateSpace{
      {2, 2, {0.5, 0.1, -0.1, 0.4}}, {2, 1, {1, 0.5}}, {1, 2, {1e-4, 5e-5}}, {1, 1, {1e-3}}};
  return made;
}

}  // namespace full_detail

inline void add_full_scene(build::ProgramSpec& spec) {
  using namespace full_detail;
  add_contacts(spec);
  spec.meshes = {
      std::make_shared<const build::MeshData>(build::make_mesh(sphere_soup(16, 9, 0.02)).value())};
  spec.curve_points = {{-0.02, 0, 0}, {0, 0.01, 0}, {0.02, 0, 0.01}};
  spec.waypoints = {{.at_s = 0, .position = {0, 0, 0}},
                    {.at_s = 1, .position = {0.01, 0, 0}, .turn = {0.8, 0, 0.6, 0}}};
  spec.paths = {{.first = 0, .count = 2, .repeat = true}};
  for (std::uint16_t c = 0; c < spec.contacts.size(); ++c) add_bodies(spec, c);
  const std::uint32_t second = spec.contacts[1].first_coordinate;
  const std::uint32_t third = spec.contacts[2].first_coordinate;
  spec.coupling = {block({0, 1, 2, second, second + 1}, 600, 0.05, -20)};
  for (std::uint32_t i = 0; i < 3; ++i) spec.coupling.push_back(general_block(third + i));
  using build::NetworkEnd;
  const NetworkEnd mass{.at = NetworkEnd::At::node, .index = 0};
  spec.networks = {{.nodes = {{.mass = 0.5}},
                    .elements = {{{NetworkEnd::At::coordinate, third}, mass, 300, 0.1, 0.01},
                                 {mass, {}, 100, 0.2, 0}}}};
}

}  // namespace hapticd::test
