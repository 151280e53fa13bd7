// Eigenvalues, singular values and exponentials of dense matrices. Eigen's decompositions are templates that take the compiler seconds
// wherever they are used: here they are compiled once.
#pragma once
#include <Eigen/Core>

namespace hapticd::algebra {

/// Of a square matrix; all NaN where an entry is not finite or the iteration did not end.
Eigen::VectorXcd eigenvalues(const Eigen::MatrixXd& square);

struct SymmetricEigen {
  Eigen::VectorXd values;   ///< ascending
  Eigen::MatrixXd vectors;  ///< orthonormal, by columns
};
/// Of symmetric and Hermitian ones; the lower triangle is read. Ascending; all NaN where an entry is not finite.
SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& symmetric);
Eigen::VectorXd symmetric_eigenvalues(const Eigen::MatrixXd& symmetric);
Eigen::VectorXd hermitian_eigenvalues(const Eigen::MatrixXcd& hermitian);

struct SingularValues {
  Eigen::VectorXd values;  ///< descending
  Eigen::MatrixXd u, v;    ///< square; matrix = u diag(values) v'
};
SingularValues singular_value_decomposition(const Eigen::MatrixXd& matrix);
/// Descending.
Eigen::VectorXd singular_values(const Eigen::MatrixXd& matrix);
Eigen::VectorXd singular_values(const Eigen::MatrixXcd& matrix);

Eigen::MatrixXd exponential(const Eigen::MatrixXd& square);

}  // namespace hapticd::algebra
