// e^A - I, by Taylor series on A/2^s and s squarings. Working on the difference to I keeps the
// relative accuracy of coefficients that are small because the interval is short: (I + D)^2 - I = 2
// D + D^2. |A/2^s| <= 1/4 in the maximum row sum, so 14 terms leave out less than 1e-21.
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace hapticd::sim {

/// `a` is square, of fixed size or not. Set-up only.
template <class Matrix>
Matrix exp_minus_identity(const Matrix& a) {
  constexpr int kTerms = 14;
  int exponent = 0;
  std::frexp(4 * a.cwiseAbs().rowwise().sum().maxCoeff(), &exponent);
  const int squarings = std::max(0, exponent);
  const Matrix scaled = a * std::ldexp(1.0, -squarings);
  Matrix d = Matrix::Zero(a.rows(), a.cols());
  for (int n = kTerms; n >= 1; --n) {
    d = (scaled / n * (Matrix::Identity(a.rows(), a.cols()) + d)).eval();
  }
  for (int i = 0; i < squarings; ++i) d = (2 * d + d * d).eval();
  return d;
}

}  // namespace hapticd::sim
