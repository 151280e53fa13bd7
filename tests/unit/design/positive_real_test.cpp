#include "control/design/check/positive_real.h"

#include <gtest/gtest.h>

#include <random>

#include "control/design/check/exact.h"
#include "control/design/check/spring_damper.h"
#include "control/design/synthesis/exact_certificate.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {
namespace {

bool provable(const System& g, const Matrix& psi) {
  const auto answer = synthesis::positive_real_certificate(g, psi, kPeriod);
  return answer.P && check::proves_positive_real(g, psi, *answer.P, kPeriod).holds;
}

TEST(InputLevel, OfExampleOneIsTheReferences) {
  const double phi = paper1_reference().at("ISP_index").at("Phi_star_isotropic");
  const System scene = paper1_scene();
  EXPECT_NEAR(-check::positive_real_margin(scene, Matrix::Zero(3, 3), kPeriod), phi, 1e-6);
  EXPECT_TRUE(provable(scene, (phi + 1e-5) * identity(3)));
  EXPECT_FALSE(provable(scene, (phi - 1e-5) * identity(3)));
}

TEST(InputLevel, OfTheDelayedSceneIsTheReferences) {
  const nlohmann::json levels = paper1_reference().at("ISP_index").at("delay1");
  for (const double share : {1.0, 0.5, 0.25}) {
    const double phi = levels.at(share == 1 ? "scale1" : share == 0.5 ? "scale0.5" : "scale0.25");
    const System late = check::scaled(check::series(check::delay(3), paper1_scene()), share);
    EXPECT_NEAR(-check::positive_real_margin(late, Matrix::Zero(3, 3), kPeriod), phi, 1e-6);
    EXPECT_TRUE(provable(late, (phi + 1e-5) * identity(3)));
    EXPECT_FALSE(provable(late, (phi - 1e-5) * identity(3)));
    const auto range = check::spring_range(phi, kDamping, kPeriod);
    EXPECT_EQ(range.low < range.high, share < 1);
    EXPECT_NEAR(range.low, 2000 * phi, 1e-3);
    EXPECT_NEAR(range.high, 2740, 1e-9);
  }
}

/// Whether a spring may stand before a scene of level phi, by the matrix form.
bool tolerates(double stiffness, double phi) {
  const Matrix level = check::tolerated_level(stiffness * identity(2), Matrix::Zero(2, 2),
                                              kDamping * identity(2), kPeriod);
  return level.size() > 0 && check::positive_definite(level - phi * identity(2));
}

TEST(ToleratedLevel, OfASpringIsTwoSided) {
  const double phi = 0.9996754196;
  EXPECT_FALSE(tolerates(1999, phi));
  EXPECT_TRUE(tolerates(2000, phi));
  EXPECT_TRUE(tolerates(2739, phi));
  EXPECT_FALSE(tolerates(2741, phi));
}

TEST(OutputLevel, OfThePublishedCouplingsIsTheClosedForm) {
  const nlohmann::json reference = paper1_reference();
  const Matrix delta = kDamping * identity(3);
  for (const char* name : {"eq26", "eq27", "eq28"}) {
    const Matrix K = matrix_of(reference.at("couplings").at(name).at("K"));
    const Matrix B = matrix_of(reference.at("couplings").at(name).at("B"));
    Matrix level = check::output_level(K, B, delta, kPeriod);
    if (std::string(name) == "eq28") {  // B < 0: one axis at a time
      EXPECT_EQ(level.size(), 0);
      level = Matrix::Zero(3, 3);
      for (Index i = 0; i < 3; ++i)
        level(i, i) = check::output_level(K(i, i), B(i, i), kDamping, kPeriod);
    }
    const nlohmann::json& diagonal = reference.at("gamma").at(name).at("DeltaV_closed_form_diag");
    for (std::size_t i = 0; i < diagonal.size(); ++i)
      EXPECT_NEAR(
          level(static_cast<Index>(i), static_cast<Index>(i)) / diagonal.at(i).get<double>(), 1,
          1e-6);
    const double isotropic = reference.at("gamma").at(name).at("DeltaV_isotropic_freqgrid");
    EXPECT_NEAR(check::smallest_eigenvalue(level) / isotropic, 1, 1e-6);
    // The template proves just below it and not above.
    const System inverse = check::inverse(check::sum(
        check::spring_damper(K, B, kPeriod), check::constant(-0.5 * kPeriod * delta.inverse())));
    EXPECT_TRUE(provable(inverse, -(1 - 1e-5) * level)) << name;
    EXPECT_FALSE(provable(inverse, -(1 + 1e-5) * level)) << name;
  }
}

TEST(InputLevel, OfThePapersHandIsNegative) {
  // 0.02 (s^2 + 60 s + 1000)/(s^2 + 10.3 s + 100) on the diagonal, 0.1 off it; s = 20 (z-1)/(z+1)
  // keeps every value on the axis.
  const double c = 20;
  Matrix A(2, 2), shifted;
  A << 0, 1, -100, -10.3;
  shifted = (c * identity(2) - A).inverse();
  const Matrix b = (Matrix(2, 1) << 0, 1).finished();
  const Matrix row = 0.02 * (Matrix(1, 2) << 900, 49.7).finished();
  const Matrix Ad = shifted * (c * identity(2) + A);
  const System one{Ad, shifted * b, row * (identity(2) + Ad),
                   Matrix::Constant(1, 1, 0.02) + row * shifted * b};
  System hand = check::beside(check::beside(one, one), one);
  hand.D += 0.1 * (Matrix::Ones(3, 3) - identity(3));
  const nlohmann::json least = paper1_reference().at("H_paper").at("min_over_omega");
  EXPECT_NEAR(check::input_level(hand), least.at("value").get<double>(), 1e-5);
}

TEST(PositiveReal, PushingSpringIsRefusedByName) {
  const System g = check::constant(-100 * identity(1));
  const auto verdict = check::proves_positive_real(g, 10 * identity(1), Matrix(0, 0), kPeriod);
  EXPECT_FALSE(verdict.holds);
  EXPECT_NE(verdict.why.find("-100"), std::string::npos) << verdict.why;
}

/// Any star network as in Example 1, of any size, stiffness and damping.
System random_scene(std::mt19937& random, std::uint32_t m, double period) {
  const auto power = [&](double low, double high) {
    return std::exp(std::uniform_real_distribution<>(std::log(low), std::log(high))(random));
  };
  build::Network network{.nodes = {{.mass = power(1e-2, 10)}}, .elements = {}};
  network.elements.push_back(element(node(0), ground(), power(1, 1e6), power(1e-4, 10)));
  for (std::uint32_t i = 0; i < m; ++i)
    network.elements.push_back(element(coordinate(i), node(0), power(1, 1e6), power(1e-4, 10)));
  return system_of(build::linear_scene({network}, period, build::Integrator::backward_euler, 1));
}

TEST(ExactCertificate, IsRightOrUndecidedAtAnySizeStiffnessAndRate) {
  std::mt19937 random(20240517);
  int yes = 0, no = 0, undecided = 0;
  for (int i = 0; i < 60; ++i) {
    const std::uint32_t m = i % 12 == 0 ? 24 : 1 + static_cast<std::uint32_t>(i % 6);
    const double period = std::exp(
        std::uniform_real_distribution<>(std::log(1.0 / 8000), std::log(1.0 / 100))(random));
    const double stiffness = std::exp(std::uniform_real_distribution<>(0, std::log(1e6))(random));
    const double latency = i % 3 == 0 ? 0 : (i % 3 == 1 ? 0.3 : 1.4) * period;
    const System f = sprung(random_scene(random, m, period), stiffness * identity(m));
    const Matrix delta =
        (std::uniform_real_distribution<>(0.2, 6)(random) * 0.5 * period * stiffness + 0.01) *
        identity(m);
    const double margin = check::exact_margin(f, delta, latency, period);
    const auto answer = synthesis::exact_certificate(f, delta, latency, period);
    const double sure = 1e-6 * delta(0, 0);
    if (answer.P) {
      ++yes;
      EXPECT_GT(margin, 0) << "case " << i << ", m " << m << ": a wrong yes";
    } else if (margin > sure) {
      ++undecided;
    } else {
      ++no;
    }
  }
  EXPECT_GT(yes, 15);
  EXPECT_GT(no, 10);
  EXPECT_LT(undecided, 6) << yes << " yes, " << no << " no";
}

}  // namespace
}  // namespace hapticd::test
