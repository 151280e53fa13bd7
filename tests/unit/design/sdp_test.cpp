#include "control/design/synthesis/sdp.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <limits>

namespace hapticd::synthesis {
namespace {

/// minimise x subject to [x, 1; 1, y] >= 0, y <= 4: x = 1/4.
SdpProblem hyperbola() {
  SdpProblem problem;
  problem.cost = Eigen::Vector2d(1, 0);
  LinearMatrix product(2), limit(1);
  product.add(0, 0, 0, 1);
  product.add(1, 1, 1, 1);
  product.add(-1, 1, 0, 1);
  limit.add(-1, 0, 0, 4);
  limit.add(1, 0, 0, -1);
  problem.blocks = {product, limit};
  return problem;
}

/// minimise t subject to t I - M >= 0: the largest eigenvalue of M.
SdpProblem eigenvalue(const Eigen::MatrixXd& m) {
  SdpProblem problem;
  problem.cost = Eigen::VectorXd::Ones(1);
  LinearMatrix block(m.rows());
  for (Eigen::Index j = 0; j < m.rows(); ++j) {
    block.add(0, j, j, 1);
    for (Eigen::Index i = 0; i <= j; ++i) block.add(-1, i, j, -m(i, j));
  }
  problem.blocks = {block};
  return problem;
}

TEST(Sdp, OptimumOnAHyperbola) {
  const SdpAnswer answer = solve(hyperbola());
  ASSERT_TRUE(answer.solved) << answer.why;
  EXPECT_NEAR(answer.objective, 0.25, 1e-7);
  EXPECT_GE(slack(hyperbola(), answer.x), 0);
}

TEST(Sdp, LargestEigenvalueOfAMatrix) {
  Eigen::MatrixXd m(3, 3);
  m << 2, 1, 0, 1, 2, 0, 0, 0, 1;
  const SdpAnswer answer = solve(eigenvalue(m));
  ASSERT_TRUE(answer.solved) << answer.why;
  EXPECT_NEAR(answer.objective, 3, 1e-6);
  // Its multiplier is the projector on the eigenvector (1, 1, 0) / sqrt 2.
  EXPECT_NEAR(answer.multipliers.at(0)(0, 1), 0.5, 1e-3);
  EXPECT_NEAR(answer.multipliers.at(0)(2, 2), 0, 1e-3);
}

TEST(Sdp, EntriesOfOnePlaceAreAddedUp) {
  SdpProblem problem = hyperbola();
  problem.blocks[1].add(-1, 0, 0, -2);
  problem.blocks[1].add(-1, 0, 0, 1);
  const SdpAnswer answer = solve(problem);  // y <= 3
  ASSERT_TRUE(answer.solved) << answer.why;
  EXPECT_NEAR(answer.objective, 1.0 / 3, 1e-7);
}

TEST(Sdp, InfeasibleIsSaidToBe) {
  SdpProblem problem = hyperbola();
  LinearMatrix below(1);
  below.add(-1, 0, 0, 0.2);
  below.add(0, 0, 0, -1);  // x <= 0.2
  problem.blocks.push_back(below);
  const SdpAnswer answer = solve(problem);
  EXPECT_TRUE(answer.infeasible);
  EXPECT_FALSE(answer.solved);
  EXPECT_FALSE(answer.why.empty());
}

TEST(Sdp, StoppedEarlyIsNeitherSolvedNorInfeasible) {
  SdpOptions options;
  options.max_iterations = 2;
  const SdpAnswer answer = solve(hyperbola(), options);
  EXPECT_FALSE(answer.solved);
  EXPECT_FALSE(answer.infeasible);
  EXPECT_FALSE(answer.why.empty());
}

TEST(Sdp, RefusesWhatIsNotFiniteOrOutOfRange) {
  SdpProblem nan = hyperbola();
  nan.blocks[0].add(0, 0, 0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(solve(nan).solved);
  EXPECT_FALSE(solve(nan).why.empty());
  SdpProblem far = hyperbola();
  far.blocks[0].add(2, 0, 0, 1);
  EXPECT_FALSE(solve(far).solved);
  EXPECT_FALSE(solve(far).why.empty());
}

TEST(Sdp, SameProblemSameBits) {
  const SdpAnswer first = solve(hyperbola()), second = solve(hyperbola());
  EXPECT_EQ(first.x, second.x);
}

TEST(Sdp, WritesNothing) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  solve(hyperbola());
  SdpProblem problem = hyperbola();
  problem.blocks[1].add(-1, 0, 0, -5);  // y <= -1
  solve(problem);
  std::fflush(nullptr);
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(Sdp, SecondSolverAgrees) {
  if (!available(SdpBackend::sdpa)) GTEST_SKIP() << "built without HAPTICD_WITH_SDPA";
  SdpOptions options;
  options.backend = SdpBackend::sdpa;
  options.gap = 1e-8;
  const SdpAnswer answer = solve(hyperbola(), options);
  ASSERT_TRUE(answer.solved) << answer.why;
  EXPECT_NEAR(answer.objective, 0.25, 1e-6);
}

}  // namespace
}  // namespace hapticd::synthesis
