// The paper's own figures for its wall: figures computed elsewhere (tests/data/paper2/design.json), and
// closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "control/design/synthesis/frequency_integral.h"
#include "control/design/synthesis/transmitted_search.h"
#include "tests/support/paper2.h"

namespace hapticd::test {
namespace {

using synthesis::Hold;
using synthesis::WallGoal;

struct NamedHold {
  const char* table;  ///< by Lyapunov equations
  const char* grid;   ///< by sweeps over frequency
  synthesis::HoldModel hold;
};
const std::vector<NamedHold> kHolds = {
    {"none", "none", {Hold::none}},
    {"AH", "AH_w: H=1/(1+sT/2),C=Bc+K/s+KT/2", {Hold::adams_hannaford}},
    {"LPF1", "LPF1(T/2)", {Hold::first_order}},
    {"zoh", "trueZOH", {Hold::zero_order}},
    {"del", "delayT/2", {Hold::delay}},
    {"avg", "avg(1+e^-sT)/2", {Hold::average}},
    {"", "LPF2z.707", {.kind = Hold::second_order, .damping_ratio = std::sqrt(0.5)}},
    {"", "LPF2z1", {.kind = Hold::second_order, .damping_ratio = 1}},
};

WallGoal paper_goal(const synthesis::HoldModel& hold) {
  return {.mass_kg = 0.01,
          .damping_Ns_m = 0.022,
          .mass_uncertainty = 0.5,
          .damping_uncertainty = 0.5,
          .stiffness_N_m = 1000,
          .wall_damping_Ns_m = 1,
          .period_s = 1e-3,
          .hold = hold};
}

WallGoal step_goal(const synthesis::HoldModel& hold) {
  WallGoal goal = paper_goal(hold);
  goal.weight = {Vector::Ones(1), Eigen::Vector2d(0, 1)};
  return goal;
}

double decibels(double gain) {
  return 20 * std::log10(gain);
}

const nlohmann::json& lyapunov_tables() {
  return paper2_design().at("lyapunov_H2_and_Linf");
}
const nlohmann::json& sweep_tables() {
  return paper2_design().at("grid_tables_w1_is_100_over_s_plus_100");
}

TEST(Transmitted, NormsAreTheReferencesForEveryHold) {
  for (const NamedHold& model : kHolds) {
    if (!*model.table) continue;
    for (const auto& [damper, expected] : lyapunov_tables().at(model.table).at("LdB").items())
      EXPECT_NEAR(decibels(synthesis::perturbation_norm(paper_goal(model.hold), std::stod(damper))),
                  expected.get<double>(), 0.005)
          << model.table << ", B_c " << damper;
  }
}

TEST(Transmitted, NormsOverTheGridAreTheReferences) {
  // The reference's sweep has 2e5 points: a resonance of 20 dB is sharper than that by up to 0.02 dB.
  const auto& grid = sweep_tables().at("grid");
  for (const NamedHold& model : kHolds) {
    const auto& expected = sweep_tables().at(model.grid).at("LdB");
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const double above = decibels(synthesis::perturbation_norm(paper_goal(model.hold), grid[i])) -
                           expected[i].get<double>();
      EXPECT_GT(above, -0.005) << model.grid << ", B_c " << grid[i];
      EXPECT_LT(above, expected[i] > 20 ? 0.02 : 0.005) << model.grid << ", B_c " << grid[i];
    }
  }
}

TEST(Transmitted, IndexAndItsMinimumAreTheReferences) {
  for (const NamedHold& model : kHolds) {
    if (!*model.table || !lyapunov_tables().at(model.table).contains("J")) continue;
    const auto& table = lyapunov_tables().at(model.table);
    for (const bool step : {false, true}) {
      const WallGoal goal = step ? step_goal(model.hold) : paper_goal(model.hold);
      for (const auto& [damper, expected] : table.at(step ? "Jstep" : "J").items())
        EXPECT_NEAR(
            synthesis::transparency_index(goal, std::stod(damper)).value / expected.get<double>(),
            1, 1e-6)
            << model.table << ", B_c " << damper;
      const synthesis::PaperDesign best = synthesis::most_transparent_damper(goal);
      EXPECT_EQ(best.why, "");
      EXPECT_NEAR(best.damper_Ns_m / table.at(step ? "argmin_step" : "argmin_w1_100").get<double>(),
                  1, 1e-6)
          << model.table;
      EXPECT_NEAR(best.answer.index / table.at(step ? "Jmin_step" : "Jmin").get<double>(), 1, 1e-6);
    }
  }
}

TEST(Transmitted, HoldsThatAreNotRationalHaveTheReferencesMinimum) {
  // The sweeps of the reference leave out the highest frequencies: 3.2e-4 of w1 = 100/(s + 100).
  for (const NamedHold& model : kHolds) {
    const auto& table = sweep_tables().at(model.grid);
    const synthesis::PaperDesign best = synthesis::most_transparent_damper(paper_goal(model.hold));
    EXPECT_NEAR(best.damper_Ns_m, table.at("argmin_w1_100").get<double>(), 1e-3) << model.grid;
    EXPECT_NEAR(best.answer.index, table.at("Jmin").get<double>() + 3.17e-4, 1e-5) << model.grid;
    const synthesis::PaperDesign step = synthesis::most_transparent_damper(step_goal(model.hold));
    EXPECT_NEAR(step.damper_Ns_m, table.at("argmin_step").get<double>(), 1e-3) << model.grid;
  }
}

TEST(Transmitted, StepWithoutAHoldHasAClosedForm) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> one(-1, 1);
  for (int trial = 0; trial < 50; ++trial) {
    WallGoal goal = step_goal({Hold::none});
    goal.mass_kg = 0.01 * std::pow(10, one(random));
    goal.damping_Ns_m = 0.02 * std::pow(10, one(random));
    goal.stiffness_N_m = 1000 * std::pow(10, one(random));
    goal.wall_damping_Ns_m = std::pow(10, one(random));
    const double m = goal.mass_kg, b = goal.damping_Ns_m, K = goal.stiffness_N_m;
    const double B = goal.wall_damping_Ns_m, damper = 5 * std::pow(10, one(random)), c = b + damper;
    const double expected =
        1 / (2 * B * K) + 1 / (2 * c * K) - (2 / B) / (m * (K / B) * (K / B) + c * K / B + K);
    EXPECT_NEAR(synthesis::transparency_index(goal, damper).value / expected, 1, 1e-7);
  }
  const synthesis::PaperDesign best = synthesis::most_transparent_damper(step_goal({Hold::none}));
  EXPECT_NEAR(best.damper_Ns_m, 1 + 0.01 * 1000 - 0.022, 1e-9);
  EXPECT_NEAR(best.answer.index * 2200, 1, 1e-9);
}

TEST(Transmitted, AdamsHannafordIsTheLagWithMoreDamper) {
  for (const double damper : {1., 4., 15., 40.}) {
    const WallGoal shifted = paper_goal({Hold::adams_hannaford}),
                   lag = paper_goal({Hold::first_order});
    EXPECT_NEAR(synthesis::perturbation_norm(shifted, damper),
                synthesis::perturbation_norm(lag, damper + 0.5), 1e-6);
    EXPECT_NEAR(synthesis::transparency_index(shifted, damper).value,
                synthesis::transparency_index(lag, damper + 0.5).value, 1e-9);
  }
}

TEST(Transmitted, RobustDampersAreTheReferences) {
  for (const NamedHold& model : kHolds) {
    const auto& expected = sweep_tables().at(model.grid).at("rob");
    const auto range = synthesis::robust_dampers(paper_goal(model.hold), {.high = 60});
    ASSERT_TRUE(range) << model.grid;
    EXPECT_NEAR(range->low, expected[0].get<double>(), 1e-3) << model.grid;
    if (expected[1].is_number()) {
      EXPECT_NEAR(range->high, expected[1].get<double>(), 2e-3) << model.grid;
    }
  }
  EXPECT_EQ(synthesis::robust_dampers(paper_goal({Hold::none}), {.high = 60})->high, 60);
}

TEST(Transmitted, ANormBelowOneIsNoStability) {
  // The reference's own sweep takes every B_c above 2.254 for robust, having looked at the norm alone.
  const WallGoal goal = paper_goal({Hold::delay});
  const synthesis::PaperAnswer far = synthesis::paper_answer(goal, 55);
  EXPECT_LT(far.norm, 1);
  EXPECT_FALSE(far.stable);
  EXPECT_FALSE(far.robust);
  EXPECT_TRUE(std::isinf(far.index));
  EXPECT_NEAR(synthesis::robust_dampers(goal)->high, 13.69, 0.01);
}

TEST(Transmitted, FourAndAHalfDecibelsAreNearAdamsHannaford) {
  EXPECT_NEAR(decibels(synthesis::perturbation_norm(paper_goal({Hold::adams_hannaford}), 0.982)),
              4.5, 0.005);
  WallGoal frictionless = paper_goal({Hold::adams_hannaford});
  frictionless.damping_Ns_m = 0;
  EXPECT_NEAR(decibels(synthesis::perturbation_norm(frictionless, 1)), 4.543, 0.005);
  const double nyquist = std::numbers::pi / 1e-3;
  EXPECT_NEAR(decibels(synthesis::perturbation_norm(paper_goal({Hold::first_order, nyquist}), 1)),
              7.269, 0.005);
}

TEST(Transmitted, CornersThatPutTheMinimumAtFifteen) {
  const struct {
    const char* name;
    synthesis::HoldModel hold;
    double first_Hz, butterworth_Hz;
  } rows[] = {
      {"none", {Hold::none}, 15.9, 71.2},         {"AH", {Hold::adams_hannaford}, 15.2, 97.5},
      {"LPF1", {Hold::first_order}, 13.35, 92.1}, {"avg", {Hold::average}, 13.2, 89.8},
      {"zoh", {Hold::zero_order}, 13.9, 99.6},    {"del", {Hold::delay}, 14.5, 106}};
  for (const auto& row : rows) {
    WallGoal goal = paper_goal(row.hold);
    const double w1 = 2 * std::numbers::pi * row.first_Hz;
    goal.weight = {Vector::Constant(1, w1), Eigen::Vector2d(w1, 1)};
    EXPECT_NEAR(synthesis::most_transparent_damper(goal).damper_Ns_m, 15, 0.1) << row.name;
    const double w2 = 2 * std::numbers::pi * row.butterworth_Hz;
    goal.weight = {Vector::Constant(1, w2 * w2), Eigen::Vector3d(w2 * w2, std::sqrt(2) * w2, 1)};
    EXPECT_NEAR(synthesis::most_transparent_damper(goal).damper_Ns_m, 15, 0.1) << row.name;
  }
}

TEST(FrequencyIntegral, RationalFunctionsHaveTheirClosedForm) {
  for (const double a : {0.3, 20., 1e4}) {
    const auto pair = [&](double w) {
      return Eigen::Vector2d(1 / (w * w + a * a), w * w / std::pow(w * w + a * a, 2));
    };
    const Eigen::Vector2d sums = synthesis::integral_over_frequency(pair, 300);
    EXPECT_NEAR(sums[0] * 2 * a / std::numbers::pi, 1, 1e-9);
    EXPECT_NEAR(sums[1] * 4 * a / std::numbers::pi, 1, 1e-6);
  }
}

TEST(Transmitted, SlopeIsTheDerivativeOfTheIndex) {
  for (const NamedHold& model : kHolds) {
    const WallGoal goal = paper_goal(model.hold);
    const double h = 1e-3, damper = 4;
    const double difference = (synthesis::transparency_index(goal, damper + h).value -
                               synthesis::transparency_index(goal, damper - h).value) /
                              (2 * h);
    EXPECT_NEAR(synthesis::transparency_index(goal, damper).slope / difference, 1, 1e-5)
        << model.grid;
  }
}

TEST(Transmitted, WeightsInStateSpaceAreTheQuotientTheyStandFor) {
  System weight{Matrix(2, 2), Matrix(2, 1), Matrix(1, 2), Matrix::Zero(1, 1)};
  weight.A << 0, 1, -4e4, -300;
  weight.B << 0, 1;
  weight.C << 4e4, 10;
  const synthesis::Rational q = synthesis::quotient(weight);
  const std::complex<double> s(3, 170);
  EXPECT_LT(std::abs(synthesis::at(q, s) - (4e4 + 10. * s) / (s * s + 300. * s + 4e4)), 1e-12);
}

TEST(Transmitted, SaysWhatItCannotRead) {
  const auto refused = [](auto change) {
    WallGoal goal = paper_goal({Hold::first_order});
    change(goal);
    return !synthesis::most_transparent_damper(goal).why.empty() &&
           !synthesis::robust_dampers(WallGoal{});
  };
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.mass_kg = std::nan(""); }));
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.damping_Ns_m = -1; }));
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.weight.den = Eigen::Vector2d(-100, 1); }));
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.weight.den = Vector::Ones(1); }));
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.weight.den = Eigen::Vector3d(0, 0, 1); }));
  EXPECT_TRUE(refused([](WallGoal& goal) { goal.wall_damping_Ns_m = 0; }));
  EXPECT_FALSE(refused([](WallGoal&) {}));
}

}  // namespace
}  // namespace hapticd::test
