// Linear matrix inequalities, written as they stand in the paper:
//
//   Lmi lmi;
//   const Affine p = lmi.symmetric(n);
//   lmi.at_least(p - A.transpose() * p * A, 1e-6);         // P - A'PA >= 1e-6 I
//   lmi.minimise(Matrix::Identity(n, n), p);               // trace P
#pragma once
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "control/design/check/linear.h"
#include "control/design/synthesis/sdp.h"

namespace hapticd::synthesis {

using check::Matrix;
using check::Vector;

/// A matrix whose entries are affine in the variables.
class Affine {
 public:
  Affine(Eigen::Index rows, Eigen::Index columns) : rows_(rows), columns_(columns) {}
  explicit Affine(const Matrix& constant);
  Eigen::Index rows() const noexcept { return rows_; }
  Eigen::Index columns() const noexcept { return columns_; }
  /// Adds `value` times the variable (-1: times 1) to one entry.
  void add(Eigen::Index variable, Eigen::Index row, Eigen::Index column, double value);
  struct Term {
    Eigen::Index variable, row, column;
    double value;
  };
  const std::vector<Term>& terms() const noexcept { return terms_; }
  Affine transpose() const;
  Matrix at(const Vector& x) const;

 private:
  Eigen::Index rows_, columns_;
  std::vector<Term> terms_;
};

Affine operator+(const Affine& a, const Affine& b);
Affine operator-(const Affine& a, const Affine& b);
Affine operator*(double factor, const Affine& a);
Affine operator*(const Matrix& left, const Affine& a);
Affine operator*(const Affine& a, const Matrix& right);
/// a + a'.
Affine twice_symmetric(const Affine& a);

/// Rows of blocks of a symmetric matrix: only those on and above the diagonal are given, row by
/// row: {{a11, a12, a13}, {a22, a23}, {a33}}.
Affine symmetric_blocks(const std::vector<std::vector<Affine>>& upper);
/// Blocks row by row, all of them.
Affine blocks(const std::vector<std::vector<Affine>>& rows);

/// Which entries of a matrix are free; the others are zero.
using Pattern = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

class Lmi {
 public:
  Affine scalar() { return symmetric(1); }
  Affine symmetric(Eigen::Index size);
  Affine symmetric(const Pattern& pattern);
  Affine full(const Pattern& pattern);
  /// value I, one variable.
  Affine isotropic(Eigen::Index size);

  /// a - shift I >= 0. `a` is symmetric: what lies below its diagonal is not read. Returns the
  /// number of the block.
  std::size_t at_least(const Affine& a, double shift = 0);
  /// Adds trace(weight' a) to the cost; what is constant in it is left out.
  void minimise(const Matrix& weight, const Affine& a);

  SdpAnswer solve(const SdpOptions& options = {}) const;
  const SdpProblem& problem() const;
  Eigen::Index variables() const noexcept { return variables_; }
  /// Variables below `count` exist, for whoever writes terms of an Affine itself.
  void reserve(Eigen::Index count) { variables_ = std::max(variables_, count); }

 private:
  Eigen::Index variables_ = 0;
  std::vector<std::pair<Eigen::Index, double>> costs_;
  mutable SdpProblem problem_;
};

}  // namespace hapticd::synthesis
