#include "control/design/synthesis/ccl_h_infinity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "control/design/check/frequency.h"
#include "tests/support/paper_loop.h"

namespace hapticd::synthesis {
namespace {

using test::eye;

/// Largest singular value over a fine grid around every pole, refined.
double swept_norm(const System& g) {
  const auto size = [&](double angle) {
    return check::largest_singular(check::at(g, check::on_circle(angle)));
  };
  return check::largest(size, check::frequency_grid(g.A, 400)).value;
}

/// Example 2: w(s) = 1 / (1 + s/125), backward Euler.
LoopShaping example2() {
  const double pole = 1 / (1 + 125 * test::kPaperPeriod_s),
               gain = 125 * test::kPaperPeriod_s * pole;
  LoopShaping shaping;
  shaping.W1 = {eye(3, pole), eye(3), eye(3, gain * pole), eye(3, gain)};
  shaping.W2 = check::constant(eye(3));
  shaping.norm = swept_norm;
  return shaping;
}

TEST(LoopShaping, NormsOfThePapersCouplingsAreTheReferences) {
  for (const char* name : {"eq26", "eq27", "eq28"}) {
    const auto& k = test::paper1_reference()["couplings"][name];
    const System v =
        spring_damper(test::matrix_of(k["K"]), test::matrix_of(k["B"]), test::kPaperPeriod_s);
    const double expected = test::paper1_reference()["gamma"][name]["loop_shaping_norm"];
    EXPECT_NEAR(swept_norm(shaped_loop(example2(), test::paper_loop(), v)), expected,
                1e-4 * expected);
  }
}

// No coupling of the class is below the infimum; a general V(z) of one state an axis comes within
// 0.1 % of it, springs and dampers within 0.5 % in as many steps.
TEST(CclHInfinity, ExampleTwoComesNearTheInfimum) {
  const HapticLoop loop = test::paper_loop();
  const double infimum = test::paper1_reference()["optimum"]["gamma_infimum"];
  for (const bool spring_damper : {true, false}) {
    Form form = decentralised(3);
    for (FormBlock& block : form) {
      block.spring_damper = spring_damper;
      block.order = 1;
    }
    CclOptions options;
    options.max_iterations = 40;
    const CclDesign design = design_transparent(loop, form, example2(), options);
    ASSERT_TRUE(design.found) << design.why;
    EXPECT_TRUE(design.proof.stable);
    EXPECT_GT(design.merit, infimum);
    EXPECT_LT(design.merit, infimum * (spring_damper ? 1.005 : 1.001));
    EXPECT_NEAR(design.merit, swept_norm(shaped_loop(example2(), loop, design.coupling.V)),
                1e-9 * infimum);
    if (!spring_damper) continue;
    const Matrix asked =
        0.5 * test::kPaperPeriod_s * design.coupling.stiffness + design.coupling.damping;
    EXPECT_GT(check::smallest_eigenvalue(loop.device_level - asked), 0);
  }
}

}  // namespace
}  // namespace hapticd::synthesis
