#include "control/design/check/linear.h"

#include <Eigen/LU>

namespace hapticd::check {

System constant(const Matrix& gain) {
  return {Matrix(0, 0), Matrix(0, gain.cols()), Matrix(gain.rows(), 0), gain};
}

ComplexMatrix at(const System& g, Complex z) {
  if (g.states() == 0) return g.D.cast<Complex>();
  ComplexMatrix resolvent = -g.A.cast<Complex>();
  resolvent.diagonal().array() += z;
  return g.D.cast<Complex>() +
         g.C.cast<Complex>() * resolvent.partialPivLu().solve(g.B.cast<Complex>());
}

Matrix at_rest(const System& g) {
  if (g.states() == 0) return g.D;
  const Matrix resolvent = Matrix::Identity(g.states(), g.states()) - g.A;
  return g.D + g.C * resolvent.partialPivLu().solve(g.B);
}

System series(const System& second, const System& first) {
  const Eigen::Index n1 = first.states(), n2 = second.states();
  System g;
  g.A = Matrix::Zero(n1 + n2, n1 + n2);
  g.A.topLeftCorner(n1, n1) = first.A;
  g.A.bottomLeftCorner(n2, n1) = second.B * first.C;
  g.A.bottomRightCorner(n2, n2) = second.A;
  g.B.resize(n1 + n2, first.inputs());
  g.B << first.B, second.B * first.D;
  g.C.resize(second.outputs(), n1 + n2);
  g.C << second.D * first.C, second.C;
  g.D = second.D * first.D;
  return g;
}

System sum(const System& a, const System& b) {
  const Eigen::Index n1 = a.states(), n2 = b.states();
  System g;
  g.A = Matrix::Zero(n1 + n2, n1 + n2);
  g.A.topLeftCorner(n1, n1) = a.A;
  g.A.bottomRightCorner(n2, n2) = b.A;
  g.B.resize(n1 + n2, a.inputs());
  g.B << a.B, b.B;
  g.C.resize(a.outputs(), n1 + n2);
  g.C << a.C, b.C;
  g.D = a.D + b.D;
  return g;
}

System scaled(const System& g, double factor) {
  return {g.A, g.B, factor * g.C, factor * g.D};
}

System beside(const System& a, const System& b) {
  const auto diagonal = [](const Matrix& p, const Matrix& q) {
    Matrix m = Matrix::Zero(p.rows() + q.rows(), p.cols() + q.cols());
    m.topLeftCorner(p.rows(), p.cols()) = p;
    m.bottomRightCorner(q.rows(), q.cols()) = q;
    return m;
  };
  return {diagonal(a.A, b.A), diagonal(a.B, b.B), diagonal(a.C, b.C), diagonal(a.D, b.D)};
}

System feedback(const System& g, const System& h) {
  const Eigen::Index n1 = g.states(), n2 = h.states();
  const Matrix around = Matrix::Identity(g.outputs(), g.outputs()) + g.D * h.D;
  const auto lu = around.partialPivLu();
  // y = S (C1 x1 - D1 C2 x2 + D1 u), S = (I + D1 D2)^-1.
  const Matrix c1 = lu.solve(g.C), c2 = lu.solve(Matrix(-g.D * h.C)), d = lu.solve(g.D);
  System loop;
  loop.A.resize(n1 + n2, n1 + n2);
  loop.A << g.A - g.B * h.D * c1, -g.B * (h.C + h.D * c2), h.B * c1, h.A + h.B * c2;
  loop.B.resize(n1 + n2, g.inputs());
  loop.B << g.B - g.B * h.D * d, h.B * d;
  loop.C.resize(g.outputs(), n1 + n2);
  loop.C << c1, c2;
  loop.D = d;
  return loop;
}

System inverse(const System& g) {
  const auto lu = g.D.partialPivLu();
  const Matrix through = lu.inverse();
  return {g.A - g.B * through * g.C, g.B * through, -through * g.C, through};
}

System delay(Eigen::Index m) {
  return {Matrix::Zero(m, m), Matrix::Identity(m, m), Matrix::Identity(m, m), Matrix::Zero(m, m)};
}

double spectral_radius(const Matrix& a) {
  return a.size() == 0 ? 0 : eigenvalues(a).cwiseAbs().maxCoeff();
}

Matrix symmetric_part(const Matrix& m) {
  return 0.5 * (m + m.transpose());
}

double smallest_eigenvalue(const Matrix& m) {
  return algebra::symmetric_eigenvalues(m).minCoeff();
}

double largest_eigenvalue(const Matrix& m) {
  return algebra::symmetric_eigenvalues(m).maxCoeff();
}

double smallest_hermitian(const ComplexMatrix& m) {
  return algebra::hermitian_eigenvalues(0.5 * (m + m.adjoint())).minCoeff();
}

double largest_singular(const ComplexMatrix& m) {
  return algebra::singular_values(m)(0);
}

}  // namespace hapticd::check
