// Matrices of a config: their sizes checked, their rows and columns put in the plan's order.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "config/schema_coupling.h"
#include "control/build/network.h"

namespace hapticd::config {

class Compilation;

// Each reports at `path` what it does not give.

/// Rows x columns as written; no rows stand for a matrix without entries only.
std::optional<Eigen::MatrixXd> matrix(Compilation& compilation, const Rows& written,
                                      std::size_t rows, std::size_t columns,
                                      const std::string& path);

/// n x n and symmetric.
std::optional<Eigen::MatrixXd> symmetric_matrix(Compilation& compilation, const Gains& gains,
                                                std::size_t n, const std::string& path);

/// A, B, C, D as they fit to each other and to n inputs and outputs.
struct LinearSystem {
  Eigen::MatrixXd A, B, C, D;
};
std::optional<LinearSystem> linear_system(Compilation& compilation, const StateSpace& written,
                                          std::size_t n, const std::string& path);

/// Is it symmetric, but for the rounding of what people write?
bool is_symmetric(const Eigen::MatrixXd& m);
/// Of a symmetric matrix.
double smallest_eigenvalue(const Eigen::MatrixXd& m);
/// Symmetric, and its smallest eigenvalue clearly above 0. `what` names it in the error.
bool check_positive(Compilation& compilation, const Eigen::MatrixXd& m, const std::string& path,
                    const std::string& what);

/// Order that sorts `coordinates`: entry i is the place of the i-th smallest.
std::vector<Eigen::Index> sorting_order(const std::vector<std::uint32_t>& coordinates);

/// Rows of equal length; ragged ones become a matrix that fits nowhere.
Eigen::MatrixXd as_matrix(const Rows& rows);
Rows as_rows(const Eigen::MatrixXd& m);

build::Matrix to_matrix(const Eigen::MatrixXd& m);
Eigen::MatrixXd to_eigen(const build::Matrix& m);

}  // namespace hapticd::config
