// build::Matrix as Eigen sees it. For .cpp files only: headers stay without Eigen.
#pragma once
#include <Eigen/Dense>

#include "control/build/network.h"

namespace hapticd::build {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

inline Eigen::MatrixXd dense(const Matrix& matrix) {
  return Eigen::Map<const RowMajor>(matrix.values.data(), static_cast<Eigen::Index>(matrix.rows),
                                    static_cast<Eigen::Index>(matrix.columns));
}

inline Matrix plain(const Eigen::MatrixXd& matrix) {
  Matrix result{.rows = static_cast<std::size_t>(matrix.rows()),
                .columns = static_cast<std::size_t>(matrix.cols()),
                .values = std::vector<double>(static_cast<std::size_t>(matrix.size()))};
  Eigen::Map<RowMajor>(result.values.data(), matrix.rows(), matrix.cols()) = matrix;
  return result;
}

inline Eigen::MatrixXd symmetric(const Eigen::MatrixXd& matrix) {
  return 0.5 * (matrix + matrix.transpose());
}

}  // namespace hapticd::build
