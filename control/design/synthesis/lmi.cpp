#include "control/design/synthesis/lmi.h"

namespace hapticd::synthesis {

Affine::Affine(const Matrix& constant) : Affine(constant.rows(), constant.cols()) {
  for (Eigen::Index j = 0; j < columns_; ++j) {
    for (Eigen::Index i = 0; i < rows_; ++i) add(-1, i, j, constant(i, j));
  }
}

void Affine::add(Eigen::Index variable, Eigen::Index row, Eigen::Index column, double value) {
  if (value != 0) terms_.push_back({variable, row, column, value});
}

Affine Affine::transpose() const {
  Affine turned(columns_, rows_);
  for (const Term& term : terms_) turned.add(term.variable, term.column, term.row, term.value);
  return turned;
}

Matrix Affine::at(const Vector& x) const {
  Matrix sum = Matrix::Zero(rows_, columns_);
  for (const Term& term : terms_) {
    sum(term.row, term.column) += term.variable < 0 ? term.value : x[term.variable] * term.value;
  }
  return sum;
}

Affine operator+(const Affine& a, const Affine& b) {
  Affine sum = a;
  for (const Affine::Term& t : b.terms()) sum.add(t.variable, t.row, t.column, t.value);
  return sum;
}

Affine operator*(double factor, const Affine& a) {
  Affine product(a.rows(), a.columns());
  for (const Affine::Term& t : a.terms())
    product.add(t.variable, t.row, t.column, factor * t.value);
  return product;
}

Affine operator-(const Affine& a, const Affine& b) {
  return a + -1.0 * b;
}

Affine operator*(const Matrix& left, const Affine& a) {
  Affine product(left.rows(), a.columns());
  for (const Affine::Term& t : a.terms()) {
    for (Eigen::Index i = 0; i < left.rows(); ++i) {
      product.add(t.variable, i, t.column, left(i, t.row) * t.value);
    }
  }
  return product;
}

Affine operator*(const Affine& a, const Matrix& right) {
  Affine product(a.rows(), right.cols());
  for (const Affine::Term& t : a.terms()) {
    for (Eigen::Index j = 0; j < right.cols(); ++j) {
      product.add(t.variable, t.row, j, t.value * right(t.column, j));
    }
  }
  return product;
}

Affine twice_symmetric(const Affine& a) {
  return a + a.transpose();
}

namespace {

void place(Affine& into, const Affine& a, Eigen::Index row, Eigen::Index column) {
  for (const Affine::Term& t : a.terms()) {
    into.add(t.variable, row + t.row, column + t.column, t.value);
  }
}

}  // namespace

Affine symmetric_blocks(const std::vector<std::vector<Affine>>& upper) {
  Eigen::Index size = 0;
  for (const std::vector<Affine>& row : upper) size += row.front().rows();
  Affine whole(size, size);
  Eigen::Index at = 0;
  for (const std::vector<Affine>& row : upper) {
    Eigen::Index column = at;
    for (const Affine& block : row) {
      place(whole, block, at, column);
      if (column != at) place(whole, block.transpose(), column, at);
      column += block.columns();
    }
    at += row.front().rows();
  }
  return whole;
}

Affine blocks(const std::vector<std::vector<Affine>>& rows) {
  Eigen::Index height = 0, width = 0;
  for (const Affine& block : rows.front()) width += block.columns();
  for (const std::vector<Affine>& row : rows) height += row.front().rows();
  Affine whole(height, width);
  Eigen::Index at = 0;
  for (const std::vector<Affine>& row : rows) {
    Eigen::Index column = 0;
    for (const Affine& block : row) {
      place(whole, block, at, column);
      column += block.columns();
    }
    at += row.front().rows();
  }
  return whole;
}

Affine Lmi::symmetric(Eigen::Index size) {
  return symmetric(Pattern::Constant(size, size, true));
}

Affine Lmi::symmetric(const Pattern& pattern) {
  Affine a(pattern.rows(), pattern.rows());
  for (Eigen::Index j = 0; j < pattern.rows(); ++j) {
    for (Eigen::Index i = 0; i <= j; ++i) {
      if (!pattern(i, j)) continue;
      a.add(variables_, i, j, 1);
      if (i != j) a.add(variables_, j, i, 1);
      ++variables_;
    }
  }
  return a;
}

Affine Lmi::full(const Pattern& pattern) {
  Affine a(pattern.rows(), pattern.cols());
  for (Eigen::Index j = 0; j < pattern.cols(); ++j) {
    for (Eigen::Index i = 0; i < pattern.rows(); ++i) {
      if (pattern(i, j)) a.add(variables_++, i, j, 1);
    }
  }
  return a;
}

Affine Lmi::isotropic(Eigen::Index size) {
  Affine a(size, size);
  for (Eigen::Index i = 0; i < size; ++i) a.add(variables_, i, i, 1);
  ++variables_;
  return a;
}

std::size_t Lmi::at_least(const Affine& a, double shift) {
  LinearMatrix block(a.rows());
  for (const Affine::Term& t : a.terms()) {
    if (t.row <= t.column) block.add(t.variable, t.row, t.column, t.value);
  }
  if (shift != 0) {
    for (Eigen::Index i = 0; i < a.rows(); ++i) block.add(-1, i, i, -shift);
  }
  problem_.blocks.push_back(std::move(block));
  return problem_.blocks.size() - 1;
}

void Lmi::minimise(const Matrix& weight, const Affine& a) {
  for (const Affine::Term& t : a.terms()) {
    if (t.variable >= 0) costs_.emplace_back(t.variable, weight(t.row, t.column) * t.value);
  }
}

const SdpProblem& Lmi::problem() const {
  problem_.cost = Vector::Zero(variables_);
  for (const auto& [variable, value] : costs_) problem_.cost[variable] += value;
  return problem_;
}

SdpAnswer Lmi::solve(const SdpOptions& options) const {
  return synthesis::solve(problem(), options);
}

}  // namespace hapticd::synthesis
