#include "control/design/synthesis/ccl.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cstdio>
#include <vector>

#include "tests/support/paper_loop.h"

namespace hapticd::synthesis {
namespace {

using test::eye;

/// As the reference: data in N s/m.
CclOptions as_reference() {
  CclOptions options;
  options.unit_Ns_m = 1;
  return options;
}

/// K T/2 + B < Delta_D: what the paper's scene, being passive, asks for.
bool closed_form(const DesignedCoupling& coupling, const HapticLoop& loop) {
  const Matrix asked = 0.5 * loop.period_s * coupling.stiffness + coupling.damping;
  return check::smallest_eigenvalue(coupling.stiffness) > 0 &&
         check::smallest_eigenvalue(loop.device_level - asked) > 0;
}

TEST(Ccl, FirstStepIsTheReferences) {
  for (const Eigen::Index m : {3, 6, 12}) {
    CclOptions options = as_reference();
    std::vector<CclStep> steps;
    options.progress = [&](const CclStep& step) {
      steps.push_back(step);
      return false;
    };
    design_by_ccl(test::paper_loop(m), decentralised(m), options);
    ASSERT_EQ(steps.size(), 1u);
    const double expected =
        test::paper1_reference()["ccl_first_step_objective_by_m"][std::to_string(m)];
    EXPECT_NEAR(steps[0].objective, expected, 2e-6 * expected);
  }
}

TEST(Ccl, FirstIterateIsVerifiedAndTheReferences) {
  const HapticLoop loop = test::paper_loop();
  const CclDesign design = design_by_ccl(loop, decentralised(3), as_reference());
  ASSERT_TRUE(design.found) << design.why;
  EXPECT_EQ(design.iterations, 1);
  EXPECT_TRUE(design.proof.stable);
  const auto& expected = test::paper1_reference()["ccl_reference_W0Z0_identity"]["first_iterate"];
  for (Eigen::Index i = 0; i < 3; ++i) {
    const double k = expected["K"][static_cast<std::size_t>(i)], b = expected["B"];
    EXPECT_NEAR(design.coupling.stiffness(i, i), k, 0.005 * k);
    EXPECT_NEAR(design.coupling.damping(i, i), b, 0.005 * b);
  }
  EXPECT_TRUE(closed_form(design.coupling, loop));
}

TEST(Ccl, ElevenStepsToThePapersTolerance) {
  CclOptions options = as_reference();
  options.merit = [](const DesignedCoupling&) { return 0.0; };
  std::vector<CclStep> steps;
  options.progress = [&](const CclStep& step) {
    steps.push_back(step);
    return true;
  };
  const CclDesign design = design_by_ccl(test::paper_loop(), decentralised(3), options);
  ASSERT_TRUE(design.found) << design.why;
  EXPECT_LT(steps.back().complementarity, 1e-4);
  EXPECT_NEAR(
      static_cast<double>(steps.size()),
      test::paper1_reference()["ccl_reference_W0Z0_identity"]["iterations_to_1e_4"].get<double>(),
      1);
}

TEST(Ccl, CentralisedCouplingIsSymmetric) {
  const HapticLoop loop = test::paper_loop();
  const CclDesign design = design_by_ccl(loop, centralised(3));
  ASSERT_TRUE(design.found) << design.why;
  EXPECT_EQ(design.coupling.stiffness, Matrix(design.coupling.stiffness.transpose()));
  EXPECT_EQ(design.coupling.damping, Matrix(design.coupling.damping.transpose()));
  EXPECT_TRUE(closed_form(design.coupling, loop));
}

TEST(Ccl, BlocksShareNothingThatTheFormKeepsApart) {
  const Form form{{.coordinates = {0, 2}}, {.coordinates = {1}}};
  const CclDesign design = design_by_ccl(test::paper_loop(), form);
  ASSERT_TRUE(design.found) << design.why;
  EXPECT_EQ(design.coupling.stiffness(0, 1), 0);
  EXPECT_EQ(design.coupling.stiffness(1, 2), 0);
  EXPECT_EQ(design.coupling.V.D(0, 1), 0);
  EXPECT_EQ(design.coupling.blocks.size(), 2u);
}

TEST(Ccl, BlocksOfAnyOrder) {
  const HapticLoop loop = test::paper_loop();
  for (const Eigen::Index order : {0, 1, 3}) {
    const Form form{{.coordinates = {0, 2}, .spring_damper = false, .order = order},
                    {.coordinates = {1}, .spring_damper = false, .order = 2}};
    const CclDesign design = design_by_ccl(loop, form);
    ASSERT_TRUE(design.found) << order << ": " << design.why;
    EXPECT_EQ(design.coupling.V.states(), order + 2);
    const Matrix rest = check::at_rest(design.coupling.V);
    EXPECT_LT((rest - rest.transpose()).norm(), 1e-9 * rest.norm());
    EXPECT_TRUE(design.proof.stable);
  }
}

TEST(Ccl, StoragesInBlocksFindACouplingOf24ContactsAndNothingIsPrinted) {
  CclOptions options;
  options.storages = Storages::blocks;
  const HapticLoop loop = test::paper_loop(24);
  testing::internal::CaptureStdout();
  const CclDesign design = design_by_ccl(loop, decentralised(24), options);
  std::fflush(stdout);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  ASSERT_TRUE(design.found) << design.why;
  EXPECT_TRUE(closed_form(design.coupling, loop));
}

TEST(Ccl, SecondSolverFindsTheSameFirstStep) {
  if (!available(SdpBackend::sdpa)) GTEST_SKIP() << "built without HAPTICD_WITH_SDPA";
  CclOptions options = as_reference();
  options.solver.backend = SdpBackend::sdpa;
  double objective = 0;
  options.progress = [&](const CclStep& step) {
    objective = step.objective;
    return false;
  };
  design_by_ccl(test::paper_loop(), decentralised(3), options);
  const double expected = test::paper1_reference()["ccl_first_step_objective_by_m"]["3"];
  EXPECT_NEAR(objective, expected, 2e-6 * expected);
}

// 2 Phi* / T < K < 2 Delta_D / T is all that B = 0 leaves, and there is a coupling in it.
TEST(Ccl, FindsACouplingForALateScene) {
  for (const double scale : {0.25, 0.5}) {
    const CclDesign design = design_by_ccl(test::late_loop(scale), decentralised(3));
    ASSERT_TRUE(design.found) << scale << ": " << design.why;
    EXPECT_TRUE(design.proof.stable);
  }
}

TEST(Ccl, SaysThatThereIsNoneForALateSceneAtFullScale) {
  const CclDesign design = design_by_ccl(test::late_loop(1), decentralised(3));
  EXPECT_FALSE(design.found);
  EXPECT_FALSE(design.why.empty());
}

TEST(Ccl, RefusesAFormThatForgetsACoordinate) {
  const CclDesign design = design_by_ccl(test::paper_loop(), {{.coordinates = {0, 1}}});
  EXPECT_FALSE(design.found);
  EXPECT_FALSE(design.why.empty());
  EXPECT_FALSE(covers({{.coordinates = {0, 1}}, {.coordinates = {1, 2}}}, 3));
}

}  // namespace
}  // namespace hapticd::synthesis
