// Networks for tests, and what they and a coupling do by their equations written out: every tick one
// dense system of all unknowns.
#pragma once
#include <Eigen/Dense>
#include <cstddef>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "control/build/coupling.h"

namespace hapticd::test {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

inline build::NetworkEnd ground() {
  return {};
}
inline build::NetworkEnd coordinate(std::uint32_t index) {
  return {.at = build::NetworkEnd::At::coordinate, .index = index};
}
inline build::NetworkEnd node(std::uint32_t index) {
  return {.at = build::NetworkEnd::At::node, .index = index};
}
inline build::NetworkElement element(build::NetworkEnd a, build::NetworkEnd b, double stiffness,
                                     double damping = 0, double rest = 0) {
  return {.a = a, .b = b, .stiffness = stiffness, .damping = damping, .rest = rest};
}
inline build::NetworkElement damper(build::NetworkEnd a, build::NetworkEnd b, double damping) {
  return element(a, b, 0, damping);
}

inline build::Matrix matrix(const std::vector<std::vector<double>>& rows) {
  build::Matrix result{
      .rows = rows.size(), .columns = rows.empty() ? 0 : rows[0].size(), .values = {}};
  for (const auto& row : rows) result.values.insert(result.values.end(), row.begin(), row.end());
  return result;
}
inline MatrixXd eigen(const build::Matrix& from) {
  MatrixXd result(from.rows, from.columns);
  for (std::size_t i = 0; i < from.rows; ++i)
    for (std::size_t j = 0; j < from.columns; ++j)
      result(static_cast<Index>(i), static_cast<Index>(j)) = from(i, j);
  return result;
}
inline VectorXd eigen(const std::vector<double>& from) {
  return Eigen::Map<const VectorXd>(from.data(), static_cast<Index>(from.size()));
}

/// Example 1 of the paper on passive couplings for several devices (tests/data/paper1).
inline nlohmann::json paper1() {
  return nlohmann::json::parse(std::ifstream(HAPTICD_SOURCE_DIR "/tests/data/paper1/network.json"));
}
inline build::Network paper1_network() {
  const nlohmann::json figures = paper1().at("parameters");
  build::Network network{.nodes = {{.mass = figures.at("M")}}, .elements = {}};
  network.elements.push_back(element(node(0), ground(), figures.at("k"), figures.at("B")));
  for (std::uint32_t i = 0; i < 3; ++i)
    network.elements.push_back(
        element(coordinate(i), node(0), figures.at("k_i").at(i), figures.at("B_i").at(i)));
  return network;
}

/// What a network does in backward Euler, from its elements.
struct LongHandNetwork {
  build::Network network;
  double period_s = 1e-3;
  VectorXd contacts, nodes, speeds;  ///< of the last tick

  LongHandNetwork(const build::Network& of, double period, const VectorXd& at)
      : network(of), period_s(period), contacts(at) {
    nodes = speeds = VectorXd::Zero(static_cast<Index>(of.nodes.size()));
    for (Index i = 0; i < nodes.size(); ++i)
      nodes(i) = of.nodes[static_cast<std::size_t>(i)].position;
  }

  static double at(build::NetworkEnd end, const VectorXd& y, const VectorXd& x) {
    if (end.at == build::NetworkEnd::At::coordinate) return y(end.index);
    return end.at == build::NetworkEnd::At::node ? x(end.index) : 0;
  }

  /// Adds the network's pull: + what its elements need at `a`, - at `b`.
  void add_forces(const VectorXd& y, const VectorXd& x, VectorXd& on_contacts,
                  VectorXd& on_nodes) const {
    for (const build::NetworkElement& e : network.elements) {
      const double long_now = at(e.a, y, x) - at(e.b, y, x);
      const double long_then = at(e.a, contacts, nodes) - at(e.b, contacts, nodes);
      const double force =
          e.stiffness * (long_now - e.rest) + e.damping * (long_now - long_then) / period_s;
      for (const auto& [end, sign] : {std::pair{e.a, 1.0}, std::pair{e.b, -1.0}}) {
        if (end.at == build::NetworkEnd::At::coordinate) on_contacts(end.index) += sign * force;
        if (end.at == build::NetworkEnd::At::node) on_nodes(end.index) += sign * force;
      }
    }
    for (Index i = 0; i < x.size(); ++i) {
      const build::NetworkNode& own = network.nodes[static_cast<std::size_t>(i)];
      const double speed = (x(i) - nodes(i)) / period_s;
      on_nodes(i) += own.mass * (speed - speeds(i)) / period_s - own.load;
    }
  }

  void accept(const VectorXd& y, const VectorXd& x) {
    speeds = (x - nodes) / period_s;
    nodes = x;
    contacts = y;
  }
};

/// Root of an affine function, refined once.
template <typename Residual>
VectorXd root_of(Index size, const Residual& residual) {
  const VectorXd origin = residual(VectorXd(VectorXd::Zero(size)));
  MatrixXd slope(size, size);
  for (Index i = 0; i < size; ++i)
    slope.col(i) = residual(VectorXd(VectorXd::Unit(size, i))) - origin;
  const Eigen::FullPivLU<MatrixXd> solver(slope);
  VectorXd z = -solver.solve(origin);
  for (int i = 0; i < 2; ++i) z -= solver.solve(residual(z));
  return z;
}

/// Force on the network with its contacts moved to y.
inline VectorXd pull(LongHandNetwork& network, const VectorXd& y) {
  const auto forces = [&](const VectorXd& x) {
    VectorXd on_contacts = VectorXd::Zero(y.size()), on_nodes = VectorXd::Zero(x.size());
    network.add_forces(y, x, on_contacts, on_nodes);
    return std::pair{on_contacts, on_nodes};
  };
  VectorXd x = network.nodes;
  if (x.size() > 0) x = root_of(x.size(), [&](const VectorXd& z) { return forces(z).second; });
  const VectorXd result = forces(x).first;
  network.accept(y, x);
  return result;
}

/// y from x and back: the recursion of a LinearScene.
struct Running {
  build::LinearScene scene;
  VectorXd eta;

  Running(build::LinearScene of, const VectorXd& y) : scene(std::move(of)) {
    eta = eigen(scene.first_states({y.begin(), y.end()}));
  }
  VectorXd move(const VectorXd& y) {
    const VectorXd f = eigen(scene.C) * eta + eigen(scene.D) * y - eigen(scene.push);
    eta = (eigen(scene.A) * eta + eigen(scene.B) * y + eigen(scene.drift)).eval();
    return f;
  }
};

}  // namespace hapticd::test
