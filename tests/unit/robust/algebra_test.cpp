// Thin over Eigen: what is added is that nothing comes out of what is not finite.
#include "control/core/algebra.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

namespace hapticd::algebra {
namespace {

TEST(Algebra, OfWhatIsNotFiniteNothingIsKnown) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Identity(3, 3);
  m(1, 1) = NAN;
  for (int i = 0; i < 3; ++i) {
    EXPECT_TRUE(std::isnan(eigenvalues(m)[i].real()));
    EXPECT_TRUE(std::isnan(symmetric_eigenvalues(m)[i]));
    EXPECT_TRUE(std::isnan(symmetric_eigen(m).values[i]));
    EXPECT_TRUE(std::isnan(hermitian_eigenvalues(m.cast<std::complex<double>>())[i]));
  }
}

TEST(Algebra, PartsPutTogetherAreTheWhole) {
  Eigen::MatrixXd m(2, 3);
  m << 1, 2, 3, 4, 5, 6.5;
  const SingularValues svd = singular_value_decomposition(m);
  EXPECT_TRUE((svd.u * svd.values.asDiagonal() * svd.v.leftCols(2).transpose()).isApprox(m, 1e-14));
  EXPECT_TRUE(svd.values.isApprox(singular_values(m), 1e-14));
  const Eigen::MatrixXd s = m * m.transpose();
  const SymmetricEigen eigen = symmetric_eigen(s);
  EXPECT_LE(eigen.values[0], eigen.values[1]);
  EXPECT_TRUE(
      (eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose()).isApprox(s, 1e-14));
  const Eigen::MatrixXd turn = exponential((Eigen::MatrixXd(2, 2) << 0, -1, 1, 0).finished());
  EXPECT_NEAR(turn(1, 0), std::sin(1.0), 1e-15);
}

}  // namespace
}  // namespace hapticd::algebra
