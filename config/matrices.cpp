#include "config/matrices.h"

#include <algorithm>
#include <numeric>

#include "config/compilation.h"
#include "config/number.h"
#include "control/core/algebra.h"

namespace hapticd::config {
namespace {

using Eigen::MatrixXd;

/// People write six digits of a figure, and the same ones on both sides of the diagonal.
constexpr double kSymmetry = 1e-9;
/// Below this share of the largest eigenvalue a matrix counts as singular.
constexpr double kLeastEigenvalue = 1e-12;

Eigen::Index as_index(std::size_t n) {
  return static_cast<Eigen::Index>(n);
}

std::string size_text(std::size_t rows, std::size_t columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

struct GainsOf {
  Compilation& compilation;
  std::size_t n;
  const std::string& path;

  std::optional<MatrixXd> operator()(double all) const {
    return MatrixXd(all * MatrixXd::Identity(as_index(n), as_index(n)));
  }
  std::optional<MatrixXd> operator()(const std::vector<double>& each) const {
    if (each.size() == n) {
      return MatrixXd(Eigen::Map<const Eigen::VectorXd>(each.data(), as_index(n)).asDiagonal());
    }
    compilation.refuse(path, "expected one number for each of the " + std::to_string(n) +
                                 " coordinates of this block, found " +
                                 std::to_string(each.size()) + "; one number alone is for all");
    return {};
  }
  std::optional<MatrixXd> operator()(const Rows& rows) const {
    auto full = matrix(compilation, rows, n, n, path);
    if (full && !is_symmetric(*full)) {
      compilation.refuse(path,
                         "expected a symmetric matrix; entries on both sides of the diagonal "
                         "have to be the same");
      return {};
    }
    return full;
  }
};

}  // namespace

std::optional<MatrixXd> matrix(Compilation& compilation, const Rows& written, std::size_t rows,
                               std::size_t columns, const std::string& path) {
  MatrixXd made(as_index(rows), as_index(columns));
  if (written.empty() && (rows == 0 || columns == 0)) return made;
  const auto fits = [&](const std::vector<double>& row) { return row.size() == columns; };
  const auto wrong = std::find_if_not(written.begin(), written.end(), fits);
  if (written.size() != rows || wrong != written.end()) {
    const std::size_t found = wrong != written.end() ? wrong->size() : columns;
    compilation.refuse(path, "expected a matrix of " + size_text(rows, columns) + ", found " +
                                 std::to_string(written.size()) + " rows" +
                                 (wrong != written.end()
                                      ? ", one of them with " + std::to_string(found) + " entries"
                                      : ""));
    return {};
  }
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) made(as_index(i), as_index(j)) = written[i][j];
  }
  return made;
}

std::optional<MatrixXd> symmetric_matrix(Compilation& compilation, const Gains& gains,
                                         std::size_t n, const std::string& path) {
  auto full = std::visit(GainsOf{compilation, n, path}, gains.value);
  if (full) *full = (0.5 * (*full + full->transpose())).eval();
  return full;
}

std::optional<LinearSystem> linear_system(Compilation& compilation, const StateSpace& written,
                                          std::size_t n, const std::string& path) {
  const std::size_t states = written.A.size();
  const auto A = matrix(compilation, written.A, states, states, path + ".A");
  const auto B = matrix(compilation, written.B, states, n, path + ".B");
  const auto C = written.C.empty() && states == 0
                     ? MatrixXd(as_index(n), 0)
                     : matrix(compilation, written.C, n, states, path + ".C");
  const auto D = matrix(compilation, written.D, n, n, path + ".D");
  if (!A || !B || !C || !D) return {};
  return LinearSystem{*A, *B, *C, *D};
}

bool is_symmetric(const MatrixXd& m) {
  return (m - m.transpose()).cwiseAbs().maxCoeff() <= kSymmetry * m.cwiseAbs().maxCoeff();
}

double smallest_eigenvalue(const MatrixXd& m) {
  return algebra::symmetric_eigenvalues(m)[0];
}

bool check_positive(Compilation& compilation, const MatrixXd& m, const std::string& path,
                    const std::string& what) {
  const double least = smallest_eigenvalue(m);
  if (least > kLeastEigenvalue * m.cwiseAbs().maxCoeff()) return true;
  compilation.refuse(path, "expected " + what +
                               " to be positive definite, found its smallest eigenvalue to be " +
                               format_number(least));
  return false;
}

std::vector<Eigen::Index> sorting_order(const std::vector<std::uint32_t>& coordinates) {
  std::vector<Eigen::Index> order(coordinates.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return coordinates[static_cast<std::size_t>(a)] < coordinates[static_cast<std::size_t>(b)];
  });
  return order;
}

MatrixXd as_matrix(const Rows& rows) {
  const std::size_t columns = rows.empty() ? 0 : rows.front().size();
  MatrixXd made(static_cast<Eigen::Index>(rows.size()), static_cast<Eigen::Index>(columns));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].size() != columns) return MatrixXd::Zero(1, 0);
    for (std::size_t j = 0; j < columns; ++j)
      made(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = rows[i][j];
  }
  return made;
}

Rows as_rows(const MatrixXd& m) {
  Rows rows(static_cast<std::size_t>(m.rows()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::VectorXd row = m.row(static_cast<Eigen::Index>(i));
    rows[i].assign(row.begin(), row.end());
  }
  return rows;
}

build::Matrix to_matrix(const MatrixXd& m) {
  build::Matrix made{.rows = static_cast<std::size_t>(m.rows()),
                     .columns = static_cast<std::size_t>(m.cols()),
                     .values = std::vector<double>(static_cast<std::size_t>(m.size()))};
  for (Eigen::Index i = 0; i < m.rows(); ++i) {
    for (Eigen::Index j = 0; j < m.cols(); ++j)
      made(static_cast<std::size_t>(i), static_cast<std::size_t>(j)) = m(i, j);
  }
  return made;
}

MatrixXd to_eigen(const build::Matrix& m) {
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const ByRows>(m.values.data(), as_index(m.rows), as_index(m.columns));
}

}  // namespace hapticd::config
