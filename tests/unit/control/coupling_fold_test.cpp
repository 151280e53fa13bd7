// Folded couplings and networks against their equations written out, and against the transfer
// functions of the paper's Example 1.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <random>

#include "control/scene/encounter.h"
#include "tests/support/couplings.h"
#include "tests/support/folded.h"

namespace hapticd::test {
namespace {

using build::CouplingBlock;
using build::GroupsSpec;
using build::Network;
using Complex = std::complex<double>;
using testing::ElementsAre;

CouplingBlock published(const std::string& equation) {
  const nlohmann::json given = paper1().at("couplings").at(equation);
  return springs({0, 1, 2}, matrix(given.at("K")), matrix(given.at("B")));
}

struct Case {
  const char* name;
  GroupsSpec spec;
};

std::vector<Case> cases() {
  const auto K = matrix({{600, -80}, {-80, 300}}), B = matrix({{0.3, 0.1}, {0.1, 0.2}});
  const auto none = matrix({{0, 0}, {0, 0}});
  return {
      {"springs alone", spec_of({springs({0, 1}, K, none), spring(2, 900)}, {}, kOneContact)},
      {"springs and dampers",
       spec_of({springs({0, 2}, K, B), spring(1, 500, 0.1)}, {}, kOneContact)},
      {"(27), full", spec_of({published("eq27")})},
      {"(28), damping below zero", spec_of({published("eq28")}, {paper1_network()})},
      {"V(z) of second order", spec_of({second_order({0, 2})}, {}, kOneContact)},
      {"V(z) beside a spring and damper",
       spec_of({second_order({1, 2}), spring(0, 700, 0.4)}, {}, kOneContact)},
      {"V(z) beside a spring", spec_of({spring(1, 700), second_order({0, 2})}, {lively(0, 1)})},
      {"network without coupling", spec_of({}, {lively(0, 2)}, kOneContact)},
      {"network with springs", spec_of({springs({0, 2}, K, none), spring(1, 500)}, {lively(2, 1)})},
      {"network with springs and dampers",
       spec_of({springs({0, 1}, K, B), spring(2, 500, 0.2)}, {lively(0, 2)})},
      {"two networks",
       spec_of({springs({0, 1, 2}, matrix({{600, -80, 20}, {-80, 300, 10}, {20, 10, 500}}),
                        matrix({{0.3, 0, 0}, {0, 0, 0}, {0, 0, 0.2}}))},
               {lively(0, 1), paper1_network()})},
      {"direct beside coupled", spec_of({spring(1, 800, 0.3)}, {}, kOneContact)},
      {"direct beside coupled in a network",
       spec_of({spring(1, 800, 0.3)}, {lively(1, 2), lively(1, 0)})},
      {"direct beside V(z) in a network",
       spec_of({second_order({0, 1})}, {lively(2, 0), lively(1, 2)})},
  };
}

/// Contacts and forces that wander; calls `compare(x, F)` each tick.
template <typename Compare>
void wander(const Compare& compare, int ticks = 400) {
  std::mt19937 random(3);
  std::normal_distribution<double> step(0, 1e-3), push(0, 3);
  VectorXd x = VectorXd::Constant(3, 0.06);
  for (int k = 0; k < ticks; ++k) {
    for (double& value : x) value += step(random);
    compare(x, VectorXd(VectorXd::NullaryExpr(3, [&] { return push(random); })));
  }
}

TEST(FoldedGroup, AnswersAsItsEquationsWrittenOut) {
  for (const Case& of : cases()) {
    ASSERT_EQ(build::problem(of.spec), "") << of.name;
    const build::Groups groups = build::fold(of.spec);
    ASSERT_EQ(groups.groups.size(), 1U) << of.name;
    const VectorXd at = VectorXd::Constant(3, 0.06);
    FoldedGroup ours(groups, 0, at);
    LongHand expected(of.spec, at);
    double force = 0, force_off = 0, place = 0, place_off = 0;
    wander([&](const VectorXd& x, const VectorXd& bodies) {
      const Answer a = ours.tick(x, bodies), b = expected.tick(x, bodies);
      force = std::max(force, b.force.cwiseAbs().maxCoeff());
      force_off = std::max(force_off, (a.force - b.force).cwiseAbs().maxCoeff());
      place = std::max(place, b.proxies.cwiseAbs().maxCoeff());
      place_off = std::max(place_off, (a.proxies - b.proxies).cwiseAbs().maxCoeff());
    });
    EXPECT_LT(force_off, 1e-12 * force) << of.name;
    EXPECT_LT(place_off, 1e-12 * place) << of.name;
  }
}

TEST(FoldedGroup, GeneralFormOfASpringAndDamperGivesTheSameForces) {
  const double T = 1e-3;
  const auto K = matrix({{600, -80, 0}, {-80, 300, 30}, {0, 30, 500}});
  const auto B = matrix({{0.3, 0.1, 0}, {0.1, 0.2, 0}, {0, 0, -0.01}});
  const MatrixXd inverse = (eigen(K) + eigen(B) / T).inverse();
  const auto plain = [](const MatrixXd& from) {
    build::Matrix result = matrix({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}});
    for (Index i = 0; i < 3; ++i)
      for (Index j = 0; j < 3; ++j)
        result(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = from(i, j);
    return result;
  };
  const MatrixXd carry = inverse * eigen(B) / T;
  const GroupsSpec special = spec_of({springs({0, 1, 2}, K, B)}, {lively(0, 2)});
  const GroupsSpec form = spec_of(
      {general({0, 1, 2},
               {.A = plain(carry), .B = plain(inverse), .C = plain(carry), .D = plain(inverse)})},
      {lively(0, 2)});
  const build::Groups one = build::fold(special), other = build::fold(form);
  EXPECT_TRUE(one.groups[0].remembers_stretch);
  EXPECT_FALSE(other.groups[0].remembers_stretch);
  FoldedGroup a(one, 0, VectorXd::Constant(3, 0.06)), b(other, 0, VectorXd::Constant(3, 0.06));
  wander([&](const VectorXd& x, const VectorXd& bodies) {
    const VectorXd f = a.tick(x, bodies).force, g = b.tick(x, bodies).force;
    ASSERT_LT((f - g).norm(), 1e-11 * (1 + f.norm()));
  });
}

/// E at s = (1 - 1/z)/T from the paper's closed form: diag(k_i + B_i s) less what the mass takes.
Eigen::Matrix3cd paper1_E(Complex s) {
  const nlohmann::json p = paper1().at("parameters");
  Eigen::Vector3cd z;
  Complex mass =
      p.at("M").get<double>() * s * s + p.at("B").get<double>() * s + p.at("k").get<double>();
  for (int i = 0; i < 3; ++i) {
    z(i) = p.at("k_i").at(static_cast<std::size_t>(i)).get<double>() +
           p.at("B_i").at(static_cast<std::size_t>(i)).get<double>() * s;
    mass += z(i);
  }
  return Eigen::Matrix3cd(z.asDiagonal()) - z * z.transpose() / mass;
}

TEST(Paper1Example1, ForcesAreThoseOfTheClosedLoopTransferFunction) {
  struct Tone {
    double omega;
    Eigen::Vector3cd x, f;
  };
  const double T = 1e-3;
  for (const std::string equation : {"", "eq26", "eq27", "eq28"}) {
    Eigen::Matrix3d K, B;
    if (!equation.empty())
      K = eigen(published(equation).stiffness), B = eigen(published(equation).damping);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> size(-1e-3, 1e-3), frequency(1, 3000);
    std::vector<Tone> tones(20);
    for (Tone& tone : tones) {
      tone.omega = frequency(random);
      for (auto& value : tone.x) value = {size(random), size(random)};
      const Complex s = (1.0 - std::exp(Complex(0, -tone.omega * T))) / T;
      const Eigen::Matrix3cd E = paper1_E(s);
      Eigen::Matrix3cd V = Eigen::Matrix3cd::Zero();
      if (!equation.empty()) V = (K.cast<Complex>() + B.cast<Complex>() * s).inverse();
      tone.f = -(Eigen::Matrix3cd::Identity() + E * V).inverse() * E * tone.x;
    }
    const build::Groups groups = build::fold(
        spec_of(equation.empty() ? std::vector<CouplingBlock>{} : std::vector{published(equation)},
                {paper1_network()}));
    FoldedGroup ours(groups, 0, VectorXd::Zero(3));
    double largest = 0, off = 0;
    for (int k = 0; k < 31000; ++k) {
      VectorXd x = VectorXd::Zero(3), f = x;
      for (const Tone& tone : tones) {
        const Complex phase = std::exp(Complex(0, tone.omega * k * T));
        x += (tone.x * phase).real();
        f += (tone.f * phase).real();
      }
      const VectorXd found = ours.tick(x, VectorXd::Zero(3)).force;
      if (k < 30000) continue;  // the mass has forgotten how it began: exp(-0.001 k) with (26)
      largest = std::max(largest, f.cwiseAbs().maxCoeff());
      off = std::max(off, (found - f).cwiseAbs().maxCoeff());
    }
    EXPECT_LT(off, 1e-10 * largest) << equation;
    EXPECT_GT(largest, 1) << equation;
  }
}

TEST(Fold, TiesOnlyContactsThatShareASpringADamperOrANetwork) {
  const GroupsSpec spec = spec_of(
      {springs({0, 3, 6}, matrix({{500, 0, 0}, {0, 600, -20}, {0, -20, 700}}),
               matrix({{1, 0, 0}, {0, 0, 0}, {0, 0, 0}}))},
      {{.nodes = {{}, {}},
        .elements = {element(coordinate(9), node(0), 5), element(node(0), ground(), 4),
                     element(coordinate(1), node(1), 5, 1), element(node(1), coordinate(12), 6)}}},
      {{0, 3}, {3, 3}, {6, 3}, {9, 3}, {12, 3}, {15, 3}});
  ASSERT_EQ(build::problem(spec), "");
  const build::Groups groups = build::fold(spec);
  EXPECT_THAT(groups.group_contacts, ElementsAre(0, 4, 1, 2, 3));
  const auto none = control::ContactPlan::kNoGroup;
  EXPECT_THAT(groups.group_of, ElementsAre(0, 1, 1, 2, 0, none));
  EXPECT_EQ(groups.groups[1].first_contact, 2U);
  EXPECT_EQ(groups.groups[1].contacts, 2);
  EXPECT_EQ(groups.groups[1].coordinates, 6);
}

TEST(Fold, SizesAndPlacesAddUpOverTheGroups) {
  GroupsSpec spec = spec_of({spring(0, 500, 1), spring(1, 600), second_order({2, 3})},
                            {lively(0, 0), lively(2, 3)}, {{0, 1}, {1, 1}, {2, 1}, {3, 1}});
  spec.sharpen = {0.1, 0, 0.2, 0.5};
  spec.max_sweeps = 7;
  spec.tolerance = 1e-9;
  spec.networks[0].elements.pop_back();
  ASSERT_EQ(build::problem(spec), "");
  const build::Groups groups = build::fold(spec);
  ASSERT_EQ(groups.groups.size(), 3U);
  const auto &a = groups.groups[0], &b = groups.groups[1], &c = groups.groups[2];
  EXPECT_EQ(a.memory, 1);
  EXPECT_EQ(b.memory, 0);  // a spring remembers nothing
  EXPECT_EQ(c.memory, 4);
  EXPECT_EQ(groups.memory, 5U);
  EXPECT_EQ(c.first_memory, 1U);
  EXPECT_EQ(c.first_state, a.states);
  EXPECT_EQ(groups.states, static_cast<std::size_t>(a.states + c.states));
  EXPECT_EQ(groups.start_offset.size(), groups.states);
  EXPECT_EQ(c.sharpen, 0.5);
  EXPECT_EQ(c.max_sweeps, 7);
  EXPECT_EQ(c.tolerance, 1e-9);
}

TEST(Fold, GiveAndHoldAreInverseWhereCoupledAndZeroWhereDirect) {
  const GroupsSpec spec =
      spec_of({springs({0, 2}, matrix({{600, -80}, {-80, 300}}), matrix({{0.3, 0.1}, {0.1, 0.2}}))},
              {lively(0, 1)}, kOneContact);
  const build::Groups groups = build::fold(spec);
  const FoldedGroup group(groups, 0, VectorXd::Zero(3));
  const MatrixXd give = group.gain(groups.groups[0].give, 3, 3),
                 hold = group.gain(groups.groups[0].hold, 3, 3);
  EXPECT_LT((give * hold - MatrixXd(Eigen::Vector3d(1, 0, 1).asDiagonal())).cwiseAbs().maxCoeff(),
            1e-14);
  EXPECT_EQ(give, give.transpose());
  EXPECT_TRUE(give.row(1).isZero(0) && hold.row(1).isZero(0));
}

}  // namespace
}  // namespace hapticd::test
