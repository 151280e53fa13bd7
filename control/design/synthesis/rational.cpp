#include "control/design/synthesis/rational.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "control/design/synthesis/balance.h"

namespace hapticd::synthesis {
namespace {

Eigen::Index degree(const Vector& polynomial) {
  Eigen::Index d = polynomial.size() - 1;
  while (d > 0 && polynomial[d] == 0) --d;
  return d;
}

/// Geometric mean of the sizes of what is not zero; 1 where nothing is.
double middle_size(const Eigen::VectorXcd& values) {
  const Eigen::ArrayXd sizes = values.array().abs();
  const double largest = sizes.size() == 0 ? 0 : sizes.maxCoeff();
  double sum = 0;
  int count = 0;
  for (const double size : sizes)
    if (size > 1e-12 * largest) sum += std::log(size), ++count;
  return count == 0 ? 1 : std::exp(sum / count);
}

}  // namespace

Vector times(const Vector& a, const Vector& b) {
  Vector product = Vector::Zero(a.size() + b.size() - 1);
  for (Eigen::Index i = 0; i < a.size(); ++i) product.segment(i, b.size()) += a[i] * b;
  return product;
}

Vector plus(const Vector& a, const Vector& b) {
  Vector sum = Vector::Zero(std::max(a.size(), b.size()));
  sum.head(a.size()) = a;
  sum.head(b.size()) += b;
  return sum;
}

Complex at(const Vector& polynomial, Complex s) {
  Complex value = 0;
  for (Eigen::Index i = polynomial.size(); i-- > 0;) value = value * s + polynomial[i];
  return value;
}

Complex at(const Rational& g, Complex s) {
  return at(g.num, s) / at(g.den, s);
}

Rational reduced(const Rational& g) {
  if (g.num.isZero(0)) return {};
  Eigen::Index zeros = 0;
  while (g.num[zeros] == 0 && zeros < degree(g.den) && g.den[zeros] == 0) ++zeros;
  return {g.num.segment(zeros, degree(g.num) + 1 - zeros),
          g.den.segment(zeros, degree(g.den) + 1 - zeros)};
}

std::string malformed(const Rational& g) {
  if (g.num.size() == 0 || g.den.size() == 0) return "a polynomial has no coefficients";
  if (!g.num.allFinite() || !g.den.allFinite()) return "a coefficient is not a finite number";
  if (g.den.isZero(0)) return "the denominator is zero";
  if (degree(g.num) > degree(g.den)) return "there are more zeros than poles";
  return {};
}

// (s I - A)^-1 = sum of s^k M_k / det, M_{n-1} = I, d_n = 1; for k = 1 .. n
//   d_{n-k} = -trace(A M_{n-k}) / k,  M_{n-k-1} = A M_{n-k} + d_{n-k} I.
Rational quotient(const System& g) {
  const Eigen::Index n = g.states();
  Rational q{Vector::Zero(n + 1), Vector::Zero(n + 1)};
  q.den[n] = 1;
  Matrix m = Matrix::Identity(n, n);
  for (Eigen::Index k = 1; k <= n; ++k) {
    q.num[n - k] = (g.C * m * g.B)(0, 0);
    const Matrix next = g.A * m;
    q.den[n - k] = -next.trace() / static_cast<double>(k);
    m = next + q.den[n - k] * Matrix::Identity(n, n);
  }
  q.num += g.D(0, 0) * q.den;
  return q;
}

System realised(const Rational& g) {
  const Eigen::Index n = degree(g.den);
  const double last = g.den[n];
  Vector num = Vector::Zero(n + 1);
  num.head(g.num.size()) = g.num / last;
  Vector den = g.den.head(n) / last;
  const double through = num[n];
  num.head(n) -= through * den;
  const double unit =
      n > 0 && den[0] != 0 ? std::pow(std::abs(den[0]), 1 / static_cast<double>(n)) : 1;
  for (Eigen::Index i = 0; i < n; ++i) {
    const double power = std::pow(unit, static_cast<double>(i - n));
    den[i] *= power;
    num[i] *= power;
  }
  System s{Matrix::Zero(n, n), Matrix::Zero(n, 1), num.head(n).transpose(),
           Matrix::Constant(1, 1, through)};
  if (n == 0) return s;
  s.A.diagonal(1).setConstant(unit);
  s.A.row(n - 1) -= unit * den.transpose();
  s.B(n - 1, 0) = unit;
  return s;
}

double abscissa(const System& g) {
  if (g.states() == 0) return -std::numeric_limits<double>::infinity();
  return check::eigenvalues(g.A).real().maxCoeff();
}

System on_disc(const System& g) {
  const Eigen::Index n = g.states();
  if (n == 0) return g;
  const double a = middle_size(check::eigenvalues(g.A));
  const Matrix identity = Matrix::Identity(n, n);
  const Eigen::PartialPivLU<Matrix> lu(a * identity - g.A);
  const double root = std::sqrt(2 * a);
  const Matrix b = lu.solve(g.B);
  return {lu.solve(a * identity + g.A), root * b, root * g.C * lu.inverse(), g.D + g.C * b};
}

Matrix output_energy(const System& g) {
  const System d = on_disc(g);
  return g.C * discrete_lyapunov(d.A, d.B * d.B.transpose()) * g.C.transpose();
}

}  // namespace hapticd::synthesis
