// The linear systems that are read back from a plan, against transfer functions written out.
#include "control/design/check/models.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/support/couplings.h"
#include "tests/support/linear_systems.h"
#include "tests/support/period.h"
#include "tests/support/program_fixture.h"
#include "tests/support/scene_fixture.h"

namespace hapticd::check {
namespace {

using test::eigen;
using test::lively;
using test::matrix;
using test::springs;

/// Three devices of one axis each, tied by what is given.
build::ProgramSpec three(std::vector<build::CouplingBlock> blocks,
                         std::vector<build::Network> networks) {
  build::ProgramSpec spec;
  for (std::uint16_t d = 0; d < 3; ++d) {
    spec.devices.push_back({.first_axis = d,
                            .axes = 1,
                            .first_coordinate = d,
                            .coordinates = 1,
                            .max_force = 1e9,
                            .max_slew = 1e9,
                            .max_stale_ticks = 3});
    spec.axes.push_back({.max_effort = 1e9, .max_velocity = 1e9, .max_step = 1e9});
    spec.contacts.push_back({.device = d, .first_coordinate = d, .coordinates = 1});
    spec.contacts.back().max_force = 1e9;
    spec.device_names.push_back(std::string(1, static_cast<char>('a' + d)));
    spec.axis_names.push_back(spec.device_names.back());
    spec.coordinate_names.push_back(spec.device_names.back());
  }
  spec.coupling = std::move(blocks);
  spec.networks = std::move(networks);
  return spec;
}

TiedModel model_of(build::ProgramSpec spec) {
  const build::Program program(std::move(spec));
  return tied_model(program.plan(), tied_devices(program.plan()).at(0));
}

Complex on_circle(double omega) {
  return std::polar(1.0, omega * test::kPeriod_s);
}
Complex sigma(Complex z) {
  return (1.0 - 1.0 / z) / test::kPeriod_s;
}

/// Of the paper's star, written out.
ComplexMatrix star(Complex s) {
  const nlohmann::json p = test::paper1_reference().at("parameters");
  ComplexMatrix z(3, 1);
  Complex rest = s * s * p.at("M").get<double>() + s * p.at("B").get<double>();
  rest += p.at("k").get<double>();
  for (Eigen::Index i = 0; i < 3; ++i) {
    const auto n = static_cast<std::size_t>(i);
    z(i) = p.at("k_i").at(n).get<double>() + s * p.at("B_i").at(n).get<double>();
    rest += z(i);
  }
  return ComplexMatrix(z.col(0).asDiagonal()) - z * z.transpose() / rest;
}

build::CouplingBlock published(const std::string& equation) {
  const nlohmann::json given = test::paper1_reference().at("couplings").at(equation);
  return springs({0, 1, 2}, matrix(given.at("K")), matrix(given.at("B")));
}

TEST(TiedModel, NetworkIsThePapersStarAtThePublishedFrequencies) {
  const TiedModel model = model_of(three({published("eq26")}, {test::paper1_network()}));
  ASSERT_EQ(model.coordinates, (std::vector<std::size_t>{0, 1, 2}));
  int count = 0;
  for (const nlohmann::json& row : test::paper1_reference().at("E_frequency_response")) {
    const double omega = row.at("omega");
    const Complex z = omega * test::kPeriod_s > 3 ? Complex(-1) : on_circle(omega);
    const ComplexMatrix found = at(model.E, z);
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) {
        const auto k = static_cast<std::size_t>(i), l = static_cast<std::size_t>(j);
        EXPECT_NEAR(found(i, j).real(), row.at("re").at(k).at(l).get<double>(), 1e-5);
        EXPECT_NEAR(found(i, j).imag(), row.at("im").at(k).at(l).get<double>(), 1e-5);
      }
    }
    ++count;
  }
  EXPECT_GE(count, 5);
}

TEST(TiedModel, FeltThroughASpringAndDamperIsTheLoopOfNetworkAndCoupling) {
  for (const char* equation : {"eq26", "eq27", "eq28"}) {
    const build::CouplingBlock block = published(equation);
    const TiedModel model = model_of(three({block}, {test::paper1_network()}));
    EXPECT_TRUE(model.spring_damper);
    EXPECT_TRUE(model.passive_network);
    EXPECT_NEAR((model.K - eigen(block.stiffness)).norm(), 0, 1e-9);
    EXPECT_NEAR((model.B - eigen(block.damping)).norm(), 0, 1e-12);
    for (const double omega : {0.3, 20.0, 66.4, 700.0, 3141.0}) {
      const Complex z = on_circle(omega);
      const ComplexMatrix V = ComplexMatrix(eigen(block.stiffness).cast<Complex>() +
                                            sigma(z) * eigen(block.damping).cast<Complex>())
                                  .inverse();
      const ComplexMatrix E = star(sigma(z));
      const ComplexMatrix F = (ComplexMatrix::Identity(3, 3) + E * V).inverse() * E;
      EXPECT_LT((at(model.V, z) - V).norm(), 1e-9 * V.norm()) << equation << " " << omega;
      EXPECT_LT((at(model.F, z) - F).norm(), 1e-9 * F.norm()) << equation << " " << omega;
    }
  }
}

TEST(TiedModel, GeneralCouplingAndDirectCoordinatesBesideIt) {
  const std::vector<build::CouplingBlock> blocks{test::second_order({0, 1})};
  const TiedModel model = model_of(three(blocks, {lively(2, 0), lively(1, 2)}));
  EXPECT_FALSE(model.all_coupled);
  EXPECT_FALSE(model.spring_damper);
  const TiedModel coupled = model_of(
      three({test::second_order({0, 1}), test::spring(2, 700, 0.4)}, {lively(2, 0), lively(1, 2)}));
  EXPECT_TRUE(coupled.all_coupled);
  EXPECT_FALSE(coupled.spring_damper);
  const auto& v = *blocks[0].state_space;
  const System V2{eigen(v.A), eigen(v.B), eigen(v.C), eigen(v.D)};
  for (const double omega : {1.0, 50.0, 900.0}) {
    const Complex z = on_circle(omega);
    const ComplexMatrix E = at(model.E, z);  // shown for the star above
    ComplexMatrix V = ComplexMatrix::Zero(3, 3);
    V.topLeftCorner(2, 2) = at(V2, z);
    const auto loop = [&] {
      return ComplexMatrix(E * (ComplexMatrix::Identity(3, 3) + V * E).inverse());
    };
    EXPECT_LT((at(model.F, z) - loop()).norm(), 1e-9 * E.norm());
    V(2, 2) = 1.0 / (700.0 + 0.4 * sigma(z));
    EXPECT_LT((at(coupled.V, z) - V).norm(), 1e-9 * V.norm());
    EXPECT_LT((at(coupled.F, z) - loop()).norm(), 1e-9 * E.norm());
  }
}

TEST(TiedModel, OnlyNamedCoordinatesAreInIt) {
  build::ProgramSpec spec = test::scene_spec(2);
  spec.coupling = {test::spring(1, 500, 0.1), test::spring(5, 300)};
  spec.networks = {
      {.nodes = {}, .elements = {test::element(test::coordinate(1), test::coordinate(5), 100)}}};
  const build::Program program(std::move(spec));
  const TiedModel model = tied_model(program.plan(), {0, 1});
  EXPECT_EQ(model.coordinates, (std::vector<std::size_t>{1, 5}));
  const Complex z = on_circle(100);
  const Complex stretch = 1.0 / (500.0 + 0.1 * sigma(z)) + 1.0 / 300.0 + 1.0 / 100.0;
  EXPECT_LT(std::abs(at(model.F, z)(0, 0) - 1.0 / stretch), 1e-9);  // all in series
  EXPECT_LT(std::abs(at(model.F, z)(0, 1) + 1.0 / stretch), 1e-9);
}

TEST(TiedModel, WithoutCouplingAndNetworkThereIsNone) {
  const build::Program program(test::scene_spec());
  EXPECT_TRUE(tied_model(program.plan(), {0}).coordinates.empty());
}

TEST(TiedModel, ANetworkOfAnotherIntegratorIsNotPassiveByConstruction) {
  build::ProgramSpec spec = three({published("eq26")}, {test::paper1_network()});
  spec.integrator = build::Integrator::trapezoid;
  EXPECT_FALSE(model_of(std::move(spec)).passive_network);
}

}  // namespace
}  // namespace hapticd::check
