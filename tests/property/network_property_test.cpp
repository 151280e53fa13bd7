// Networks of any make.
#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/support/generators.h"
#include "tests/support/networks.h"

namespace hapticd::test {
namespace {

using build::Integrator;
using build::Network;

/// Over four decades.
double any_figure(double scale) {
  return scale * std::pow(10, any_number(-2, 2));
}

bool any_choice() {
  return *rc::gen::inRange(0, 2) == 0;
}

/// A node below `nodes`, one of two coordinates, or ground where there is one.
build::NetworkEnd any_end(std::uint32_t nodes, bool grounded) {
  const auto i =
      static_cast<std::uint32_t>(*rc::gen::inRange(0, static_cast<int>(nodes + 2 + grounded)));
  if (i < nodes) return node(i);
  return i < nodes + 2 ? coordinate(i - nodes) : ground();
}

/// A spring, a damper or both.
build::NetworkElement any_element(build::NetworkEnd a, build::NetworkEnd b) {
  const int kind = *rc::gen::inRange(0, 3);
  return element(a, b, kind == 0 ? 0 : any_figure(500), kind == 1 ? 0 : any_figure(1));
}

/// Each node hangs on something before it; more elements go anywhere. Half the nodes have no mass.
Network any_network(bool grounded) {
  Network network;
  const auto nodes = static_cast<std::uint32_t>(*rc::gen::inRange(0, 5));
  network.elements.push_back(
      any_element(coordinate(0), grounded && any_choice() ? ground() : coordinate(1)));
  for (std::uint32_t i = 0; i < nodes; ++i) {
    network.nodes.push_back({.mass = any_choice() ? any_figure(0.3) : 0});
    network.elements.push_back(any_element(node(i), any_end(i, grounded)));
  }
  for (int more = *rc::gen::inRange(0, 5); more > 0; --more) {
    const build::NetworkEnd a = any_end(nodes, false), b = any_end(nodes, grounded);
    if (a.at != b.at || a.index != b.index) network.elements.push_back(any_element(a, b));
  }
  RC_ASSERT(build::problem({network}, 2) == "");
  return network;
}

/// Loads, stretched springs, nodes anywhere.
Network disturbed(Network network) {
  for (auto& one : network.nodes)
    one.position = any_number(-0.1, 0.1), one.load = any_number(-3, 3);
  for (auto& one : network.elements) one.rest = any_number(-0.1, 0.1);
  return network;
}

/// y wanders; f(y) each tick.
template <typename Each>
void wander(const VectorXd& from, int ticks, const Each& each) {
  VectorXd y = from;
  for (int k = 0; k < ticks; ++k) {
    for (double& value : y) value += any_number(-1e-3, 1e-3);
    each(y);
  }
}

/// The touched ones of both coordinates.
VectorXd touched(const build::LinearScene& scene, const VectorXd& y) {
  VectorXd result(static_cast<Index>(scene.coordinates.size()));
  for (Index i = 0; i < result.size(); ++i)
    result(i) = y(scene.coordinates[static_cast<std::size_t>(i)]);
  return result;
}

/// The force that the stiffest element bears when it is stretched by 1 m within a tick: what
/// rounding is measured by, however soft the whole is.
double stiffest_within(const Network& network, double period_s) {
  double most = 0;
  for (const build::NetworkElement& one : network.elements)
    most = std::max(most, one.stiffness + one.damping / period_s);
  return most;
}

RC_GTEST_PROP(Network, AnswersAsItsEquationsWrittenOut, ()) {
  const Network network = disturbed(any_network(true));
  const double period_s = std::pow(10, any_number(-4, -2));
  const auto scene = build::linear_scene({network}, period_s, Integrator::backward_euler, 1);
  const VectorXd start = VectorXd::Constant(2, 0.05);
  LongHandNetwork expected(network, period_s, start);
  Running ours(scene, touched(scene, start));
  double largest = 0, off = 0;
  wander(start, 30, [&](const VectorXd& y) {
    const VectorXd full = pull(expected, y), force = touched(scene, full);
    largest = std::max(largest, force.cwiseAbs().maxCoeff());
    off = std::max(off, (ours.move(touched(scene, y)) - force).cwiseAbs().maxCoeff());
  });
  RC_ASSERT(off <= 1e-9 * largest);
}

RC_GTEST_PROP(Network, FeedThroughOfBackwardEulerIsSymmetricAndNotNegative, ()) {
  const Network network = any_network(true);
  const auto scene = build::linear_scene({network}, std::pow(10, any_number(-4, -2)),
                                         Integrator::backward_euler, 1);
  const MatrixXd D = eigen(scene.D);
  RC_ASSERT(D == D.transpose());
  RC_ASSERT(D.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff() >=
            -1e-12 * D.cwiseAbs().maxCoeff());
}

RC_GTEST_PROP(Network, GivesBackNoMoreEnergyThanItGotInBackwardEuler, ()) {
  const Network network = any_network(true);
  const double period_s = std::pow(10, any_number(-4, -2));
  const auto scene = build::linear_scene({network}, period_s, Integrator::backward_euler, 1);
  VectorXd before = VectorXd::Zero(2);
  Running ours(scene, touched(scene, before));
  double work = 0, turned_over = 0, rounding = 0;
  wander(before, 60, [&](const VectorXd& y) {
    const double done = ours.move(touched(scene, y)).dot(touched(scene, y - before));
    work += done;
    turned_over += std::abs(done);
    rounding += 1e-13 * stiffest_within(network, period_s) * y.norm() * (y - before).norm();
    before = y;
    RC_ASSERT(work >= -1e-10 * turned_over - rounding);
  });
}

RC_GTEST_PROP(Network, MovedAsAWholeWithoutGroundItFeelsNothing, ()) {
  Network network = any_network(false);
  const VectorXd far = VectorXd::Constant(2, 0.5);
  for (auto& one : network.nodes) one.position = 0.5;
  for (const Integrator integrator :
       {Integrator::backward_euler, Integrator::trapezoid, Integrator::exact}) {
    const auto scene = build::linear_scene({network}, 1e-3, integrator, 2);
    Running ours(scene, touched(scene, far));
    for (int k = 0; k < 20; ++k) {
      const VectorXd force = ours.move(touched(scene, far));
      RC_ASSERT(force.cwiseAbs().maxCoeff() <=
                1e-9 * far.maxCoeff() * stiffest_within(network, 1e-3));
    }
  }
}

}  // namespace
}  // namespace hapticd::test
