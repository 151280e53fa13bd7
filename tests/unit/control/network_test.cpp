// Networks as E(z), against the papers' figures and against their equations written out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "tests/support/networks.h"
#include "tests/support/period.h"

namespace hapticd::test {
namespace {

using build::Integrator;
using build::Network;
using Complex = std::complex<double>;

using test::kPeriod_s;

build::LinearScene scene(const Network& network, Integrator integrator = Integrator::backward_euler,
                         std::size_t substeps = 1, double period_s = kPeriod_s) {
  return build::linear_scene({network}, period_s, integrator, substeps);
}

Eigen::MatrixXcd response(const build::LinearScene& of, double omega) {
  const Complex z = std::exp(Complex(0, omega * kPeriod_s));
  const MatrixXd A = eigen(of.A);
  const Eigen::MatrixXcd back = z * MatrixXd::Identity(A.rows(), A.rows()) - A;
  return eigen(of.C) * back.partialPivLu().solve(eigen(of.B).cast<Complex>()) + eigen(of.D);
}

MatrixXd matrix_of(const nlohmann::json& rows) {
  return eigen(matrix(rows.get<std::vector<std::vector<double>>>()));
}

TEST(Paper1Network, FrequencyResponseIsThePapers) {
  const auto of = scene(paper1_network());
  const nlohmann::json rows = paper1().at("E_frequency_response");
  ASSERT_EQ(rows.size(), 5U);
  for (const auto& row : rows) {
    const Eigen::MatrixXcd found = response(of, row.at("omega"));
    const MatrixXd re = matrix_of(row.at("re")), im = matrix_of(row.at("im"));
    const double scale = std::max(re.cwiseAbs().maxCoeff(), im.cwiseAbs().maxCoeff());
    EXPECT_LT((found.real() - re).cwiseAbs().maxCoeff(), 1e-9 * scale) << row.at("omega");
    EXPECT_LT((found.imag() - im).cwiseAbs().maxCoeff(), 1e-9 * scale) << row.at("omega");
  }
}

TEST(Paper1Network, AnswersAnyMotionAsThePapersStateSpace) {
  const nlohmann::json given = paper1().at("E_state_space");
  const MatrixXd A = matrix_of(given.at("A")), B = matrix_of(given.at("B")),
                 C = matrix_of(given.at("C")), D = matrix_of(given.at("D"));
  VectorXd state = VectorXd::Zero(A.rows());
  Running ours(scene(paper1_network()), VectorXd::Zero(3));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> step(-1e-4, 1e-4);
  VectorXd y = VectorXd::Zero(3);
  double largest = 0, off = 0;
  for (int k = 0; k < 2000; ++k) {
    for (double& value : y) value += step(random);
    const VectorXd expected = C * state + D * y;
    state = (A * state + B * y).eval();
    largest = std::max(largest, expected.cwiseAbs().maxCoeff());
    off = std::max(off, (ours.move(y) - expected).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(off, 1e-10 * largest);
}

TEST(Paper1Network, HasThePapersFiveStatesAndAFeedThroughThatIsSymmetric) {
  const auto of = scene(paper1_network());
  EXPECT_EQ(of.A.rows, 5U);  // a mass, and a damper at each contact
  const MatrixXd D = eigen(of.D);
  EXPECT_EQ(D, D.transpose());
  EXPECT_LT((D - matrix_of(paper1().at("E_state_space").at("D"))).cwiseAbs().maxCoeff(), 1e-9);
}

struct Order {
  const char* name;
  Network network;
  std::size_t states;
};

std::vector<Order> orders() {
  const auto y = coordinate(0), z = coordinate(1), a = node(0), b = node(1), c = node(2);
  const auto joints = [](std::size_t count) { return std::vector<build::NetworkNode>(count); };
  return {
      {"spring", {{}, {element(y, ground(), 100)}}, 0},
      {"spring and damper", {{}, {element(y, ground(), 100, 1)}}, 1},
      {"damper between two contacts", {{}, {damper(y, z, 1)}}, 1},
      {"springs in series",
       {joints(2), {element(y, a, 100), element(a, b, 70), element(b, z, 50)}},
       0},
      {"dampers in series", {joints(1), {damper(y, a, 1), damper(a, z, 2)}}, 1},
      {"spring behind a damper", {joints(1), {damper(y, a, 1), element(a, ground(), 100)}}, 1},
      {"damper, spring, damper",
       {joints(2), {damper(y, a, 1), element(a, b, 50), damper(b, z, 2)}},
       1},
      {"spring, damper, spring",
       {joints(2), {element(y, a, 20), damper(a, b, 3), element(b, z, 50)}},
       1},
      {"mass on a spring", {{{.mass = 1}}, {element(y, a, 100)}}, 2},
      {"mass on a damper", {{{.mass = 1}}, {damper(y, a, 1)}}, 2},
      {"mass on a spring and a damper", {{{.mass = 1}}, {element(y, a, 100, 1)}}, 3},
      {"mass behind damper and spring",
       {{{}, {.mass = 1}}, {damper(y, a, 1), element(a, b, 80)}},
       2},
      {"two masses in a row",
       {{{.mass = 1}, {.mass = 2}}, {element(y, a, 100), element(a, b, 60)}},
       4},
      {"two masses between dampers",
       {{{.mass = 1}, {.mass = 2}}, {damper(y, a, 1), element(a, b, 60), damper(b, z, 2)}},
       5},
      {"what no contact feels",
       {{{}, {.mass = 1}, {}},
        {element(y, a, 100), element(a, ground(), 5), element(b, c, 60),
         element(c, ground(), 7, 1)}},
       0},
  };
}

TEST(Network, HasNoMoreStatesThanItsOrder) {
  for (const Order& row : orders()) EXPECT_EQ(scene(row.network).A.rows, row.states) << row.name;
}

TEST(Network, AnswersAsItsEquationsWrittenOut) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> step(-1e-3, 1e-3);
  for (const Order& row : orders()) {
    const auto of = scene(row.network);
    VectorXd y = VectorXd::Constant(2, 0.1);
    LongHandNetwork expected(row.network, kPeriod_s, y);
    const auto m = static_cast<Index>(of.coordinates.size());
    Running ours(of, y.head(m));
    double largest = 0, off = 0;
    for (int k = 0; k < 300; ++k) {
      for (double& value : y) value += step(random);
      const VectorXd force = pull(expected, y).head(m);
      largest = std::max(largest, force.cwiseAbs().maxCoeff());
      off = std::max(off, (ours.move(y.head(m)) - force).cwiseAbs().maxCoeff());
    }
    EXPECT_GT(largest, 0) << row.name;
    EXPECT_LT(off, 1e-11 * largest) << row.name;
  }
}

TEST(Network, SpringsInSeriesCarryTheSameForceWithTheirRestLengthsAddedUp) {
  // 1/100 + 1/300 m/N; the node takes a load of 3 N as well.
  const Network network{.nodes = {{.load = 3}},
                        .elements = {element(coordinate(0), node(0), 100, 0, 0.05),
                                     element(node(0), ground(), 300, 0, 0.02)}};
  Running ours(scene(network), VectorXd::Constant(1, 0.1));
  // 100 (y - x - 0.05) = 300 (x - 0.02) - 3 at y = 0.1: x = 0.035.
  EXPECT_NEAR(ours.move(VectorXd::Constant(1, 0.1))(0), 100 * (0.1 - 0.035 - 0.05), 1e-14);
}

TEST(Network, MassThatStartsInBalanceStaysThere) {
  // 2 kg hang from the contact: 400 (y - x - 0.3) = 2 * 9.81, with a damper to ground.
  const double x = 0.5 - 0.3 - 2 * 9.81 / 400;
  const Network network{
      .nodes = {{.mass = 2, .position = x, .load = -2 * 9.81}},
      .elements = {element(coordinate(0), node(0), 400, 3, 0.3), damper(node(0), ground(), 5)}};
  for (const Integrator integrator :
       {Integrator::backward_euler, Integrator::trapezoid, Integrator::exact}) {
    Running ours(scene(network, integrator, 3), VectorXd::Constant(1, 0.5));
    for (int k = 0; k < 1000; ++k)
      ASSERT_NEAR(ours.move(VectorXd::Constant(1, 0.5))(0), 2 * 9.81, 1e-10) << k;
  }
}

TEST(Network, MassThatStartsOutOfBalanceFallsInTheFirstTick) {
  const Network network{.nodes = {{.mass = 2, .position = 0.1, .load = 6}},
                        .elements = {element(coordinate(0), node(0), 400)}};
  Running ours(scene(network), VectorXd::Constant(1, 0.1));
  // 2 (x - 0.1) / T^2 = 6 + 400 (0.1 - x)
  const double moved = 6 / (2e6 + 400);
  EXPECT_NEAR(ours.move(VectorXd::Constant(1, 0.1))(0), -400 * moved, 1e-14);
}

TEST(Network, ALoadOnDampersAloneIsCarriedByThem) {
  const Network network{
      .nodes = {{.load = 4}},
      .elements = {damper(coordinate(0), node(0), 1), damper(node(0), ground(), 3)}};
  Running ours(scene(network), VectorXd::Constant(1, 0.2));
  for (int k = 0; k < 5; ++k)  // shared as the dampers are: 4 N * 1 / (1 + 3)
    EXPECT_NEAR(ours.move(VectorXd::Constant(1, 0.2))(0), -1, 1e-13);
}

/// Force on the network after `ticks` of a contact that moves at 1 m/s from rest.
double after_ramp(const Network& network, Integrator integrator, std::size_t substeps, int ticks,
                  double period_s) {
  Running ours(scene(network, integrator, substeps, period_s), VectorXd::Zero(1));
  double force = 0;
  for (int k = 1; k <= ticks; ++k) force = ours.move(VectorXd::Constant(1, k * period_s))(0);
  return force;
}

TEST(ExactIntegrator, MassOnASpringPulledAtConstantSpeedSwingsAsASine) {
  const Network network{.nodes = {{.mass = 0.5}},
                        .elements = {element(coordinate(0), node(0), 800)}};
  const double omega = 40;
  for (const int ticks : {1, 2, 7, 30})
    for (const double period_s : {1e-3, 0.05, 0.4})
      EXPECT_NEAR(after_ramp(network, Integrator::exact, 1, ticks, period_s),
                  800 * std::sin(omega * ticks * period_s) / omega, 1e-10)
          << ticks << " " << period_s;
}

TEST(ExactIntegrator, MassOnADamperPulledAtConstantSpeedGathersItExponentially) {
  const Network network{.nodes = {{.mass = 0.5}}, .elements = {damper(coordinate(0), node(0), 2)}};
  for (const int ticks : {1, 2, 50})
    EXPECT_NEAR(after_ramp(network, Integrator::exact, 1, ticks, 0.01),
                2 * std::exp(-2 / 0.5 * ticks * 0.01), 1e-12);
}

TEST(Integrators, ErrorFallsWithTheOrderOfEachUnderSubsteps) {
  const Network network = {
      .nodes = {{.mass = 0.5}, {}},
      .elements = {element(coordinate(0), node(0), 800, 0.5), element(node(0), node(1), 300),
                   damper(node(1), ground(), 4)}};
  const auto error = [&](Integrator integrator, std::size_t substeps) {
    return std::abs(after_ramp(network, integrator, substeps, 9, 0.01) -
                    after_ramp(network, Integrator::exact, 1, 9, 0.01));
  };
  EXPECT_NEAR(error(Integrator::backward_euler, 200) / error(Integrator::backward_euler, 400), 2,
              0.05);
  EXPECT_NEAR(error(Integrator::trapezoid, 20) / error(Integrator::trapezoid, 40), 4, 0.1);
  EXPECT_GT(error(Integrator::backward_euler, 200), 1e-4);
}

TEST(Integrators, SubstepsAreTheSmallerPeriodAlongAStraightLine) {
  const Network network = paper1_network();
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::trapezoid}) {
    Running coarse(scene(network, integrator, 4), VectorXd::Zero(3));
    Running fine(scene(network, integrator, 1, kPeriod_s / 4), VectorXd::Zero(3));
    VectorXd y = VectorXd::Zero(3);
    for (int k = 0; k < 50; ++k) {
      const VectorXd step(Eigen::Vector3d(1e-3 * std::sin(k), 2e-4 * k, -1e-3 * std::cos(2.0 * k)));
      VectorXd expected;
      for (int i = 1; i <= 4; ++i) expected = fine.move(y + i / 4.0 * step);
      y += step;
      const VectorXd found = coarse.move(y);
      ASSERT_LT((found - expected).norm(), 1e-10 * (1 + expected.norm())) << k;
    }
  }
}

TEST(Network, SeparatesWhatNothingTies) {
  const Network network{
      .nodes = {{.mass = 1}, {.mass = 2}, {.mass = 3}},
      .elements = {element(coordinate(4), node(1), 10), element(node(0), ground(), 5),
                   element(coordinate(2), node(2), 20, 1), element(node(2), ground(), 3),
                   element(coordinate(2), coordinate(4), 0)}};
  const auto parts = build::separate(network);
  ASSERT_EQ(parts.size(), 2U);
  ASSERT_EQ(parts[0].nodes.size(), 1U);
  EXPECT_EQ(parts[0].nodes[0].mass, 2);
  EXPECT_EQ(parts[0].elements.size(), 1U);
  ASSERT_EQ(parts[1].nodes.size(), 1U);
  EXPECT_EQ(parts[1].nodes[0].mass, 3);
  EXPECT_EQ(parts[1].elements.size(), 2U);
  EXPECT_EQ(parts[1].elements[0].b.index, 0U);
}

TEST(NetworkProblem, SaysWhatIsWrongAndWhere) {
  const auto y = coordinate(0), a = node(0), b = node(1);
  const auto says = [](const Network& network) { return build::problem({{}, network}, 1); };
  EXPECT_EQ(says(paper1_network()),
            "network 1: element 2: it ends at coordinate 1, but there are 1");
  EXPECT_EQ(says({{{}}, {element(y, a, 5)}}), "");
  EXPECT_THAT(says({{{.mass = -1}}, {element(y, a, 5)}}),
              testing::HasSubstr("node 0: its mass is negative"));
  EXPECT_THAT(says({{{.load = NAN}}, {element(y, a, 5)}}),
              testing::HasSubstr("node 0: a figure is not finite"));
  EXPECT_THAT(says({{{}}, {element(y, a, -5)}}),
              testing::HasSubstr("element 0: its stiffness is negative"));
  EXPECT_THAT(says({{{}}, {element(y, a, 5, -1)}}),
              testing::HasSubstr("element 0: its damping is negative"));
  EXPECT_THAT(says({{{}}, {element(y, a, 5, 0, INFINITY)}}), testing::HasSubstr("not finite"));
  EXPECT_THAT(says({{{}}, {element(y, b, 5)}}), testing::HasSubstr("node 1, but there are 1"));
  EXPECT_THAT(says({{{}}, {element(a, a, 5)}}), testing::HasSubstr("begins where it ends"));
  EXPECT_THAT(says({{{}, {}}, {element(y, ground(), 5), element(a, b, 5)}}),
              testing::HasSubstr("node 0 has no mass"));
  EXPECT_THAT(says({{{}, {}}, {element(y, a, 5)}}), testing::HasSubstr("node 1 has no mass"));
  EXPECT_THROW(scene({{{}}, {}}), std::invalid_argument);
}

}  // namespace
}  // namespace hapticd::test
