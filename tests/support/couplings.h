// Couplings and networks to fold, for tests.
#pragma once
#include <cstdint>
#include <utility>
#include <vector>

#include "tests/support/networks.h"

namespace hapticd::test {

inline build::CouplingBlock springs(std::vector<std::uint32_t> coordinates,
                                    const build::Matrix& stiffness, const build::Matrix& damping) {
  return {.coordinates = std::move(coordinates),
          .stiffness = stiffness,
          .damping = damping,
          .state_space = {}};
}
inline build::CouplingBlock spring(std::uint32_t coordinate, double stiffness, double damping = 0) {
  return springs({coordinate}, matrix({{stiffness}}), matrix({{damping}}));
}
inline build::CouplingBlock general(std::vector<std::uint32_t> coordinates,
                                    const build::CouplingBlock::StateSpace& v) {
  return {.coordinates = std::move(coordinates), .stiffness = {}, .damping = {}, .state_space = v};
}
/// Two states per coordinate, coupled, with a feed-through of (500 N/m)^-1 and more.
inline build::CouplingBlock second_order(std::vector<std::uint32_t> coordinates) {
  return general(
      std::move(coordinates),
      {.A = matrix(
           {{0.7, 0.2, 0, 0.1}, {-0.2, 0.6, 0.05, 0}, {0, 0, 0.5, -0.3}, {0.1, 0, 0.3, 0.4}}),
       .B = matrix({{1, 0.2}, {0.1, -0.5}, {0.3, 1}, {0, 0.7}}),
       .C = matrix({{2e-4, 1e-4, 0, 1e-5}, {-1e-4, 0, 3e-4, 1e-4}}),
       .D = matrix({{2e-3, 3e-4}, {3e-4, 1e-3}})});
}

/// A mass, a lag behind it and springs that are stretched at the start, between coordinates a and b.
inline build::Network lively(std::uint32_t a, std::uint32_t b) {
  return {.nodes = {{.mass = 0.4, .position = 0.05, .load = 2}, {.position = 0.08}, {}},
          .elements = {element(coordinate(a), node(0), 900, 0.3, 0.02),
                       element(node(0), node(1), 300), damper(node(1), coordinate(b), 2),
                       element(node(1), node(2), 50), element(node(2), ground(), 700, 0, -0.01),
                       element(coordinate(b), ground(), 40, 1)}};
}

/// Each coordinate is a contact of its own unless `contacts` says otherwise.
inline build::GroupsSpec spec_of(std::vector<build::CouplingBlock> blocks,
                                 std::vector<build::Network> networks = {},
                                 std::vector<build::GroupsSpec::ContactRange> contacts = {
                                     {0, 1}, {1, 1}, {2, 1}}) {
  build::GroupsSpec spec;
  spec.blocks = std::move(blocks);
  spec.networks = std::move(networks);
  spec.contacts = std::move(contacts);
  return spec;
}

inline const std::vector<build::GroupsSpec::ContactRange> kOneContact = {{0, 3}};

}  // namespace hapticd::test
