#include "control/core/algebra.h"

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

namespace hapticd::algebra {

using Eigen::MatrixXcd;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

template <typename Matrix>
VectorXd self_adjoint_eigenvalues(const Matrix& matrix) {
  if (!matrix.allFinite()) return VectorXd::Constant(matrix.rows(), kUnknown);
  return Eigen::SelfAdjointEigenSolver<Matrix>(matrix, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace

Eigen::VectorXcd eigenvalues(const MatrixXd& square) {
  const Eigen::VectorXcd unknown = Eigen::VectorXcd::Constant(square.rows(), kUnknown);
  if (!square.allFinite()) return unknown;
  const Eigen::EigenSolver<MatrixXd> solver(square, false);
  return solver.info() == Eigen::Success ? solver.eigenvalues() : unknown;
}

SymmetricEigen symmetric_eigen(const MatrixXd& symmetric) {
  const Eigen::Index n = symmetric.rows();
  if (!symmetric.allFinite())
    return {VectorXd::Constant(n, kUnknown), MatrixXd::Constant(n, n, kUnknown)};
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VectorXd symmetric_eigenvalues(const MatrixXd& symmetric) {
  return self_adjoint_eigenvalues(symmetric);
}

VectorXd hermitian_eigenvalues(const MatrixXcd& hermitian) {
  return self_adjoint_eigenvalues(hermitian);
}

SingularValues singular_value_decomposition(const MatrixXd& matrix) {
  const Eigen::JacobiSVD<MatrixXd> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return {svd.singularValues(), svd.matrixU(), svd.matrixV()};
}

VectorXd singular_values(const MatrixXd& matrix) {
  return Eigen::JacobiSVD<MatrixXd>(matrix).singularValues();
}

VectorXd singular_values(const MatrixXcd& matrix) {
  return Eigen::JacobiSVD<MatrixXcd>(matrix).singularValues();
}

MatrixXd exponential(const MatrixXd& square) {
  return square.exp();
}

}  // namespace hapticd::algebra
