#include "control/design/synthesis/balance.h"

#include <Eigen/Dense>
#include <algorithm>

namespace hapticd::synthesis {

using check::Matrix;
using check::System;
using check::Vector;

Matrix discrete_lyapunov(const Matrix& a, const Matrix& q) {
  Matrix x = q, power = a;
  // 2^60 terms: more than any spectral radius below 1 in double precision asks for.
  for (int i = 0; i < 60 && power.cwiseAbs().maxCoeff() > 1e-18; ++i) {
    x += power * x * power.transpose();
    power = (power * power).eval();
  }
  return 0.5 * (x + x.transpose());
}

bool well_conditioned(const Matrix& square, double least) {
  if (!square.allFinite()) return false;
  if (square.size() == 0) return true;
  const Vector s = algebra::singular_values(square);
  return s[s.size() - 1] > least * s[0];
}

namespace {

/// L with L L' = w, for w >= 0 up to roundoff.
Matrix square_root(const Matrix& w) {
  const algebra::SymmetricEigen eigen = algebra::symmetric_eigen(w);
  return eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
}

}  // namespace

std::optional<System> balanced(const System& g, double tolerance) {
  if (g.states() == 0) return g;
  if (!(check::spectral_radius(g.A) < 1)) return std::nullopt;
  const Matrix reach = discrete_lyapunov(g.A, g.B * g.B.transpose());
  const Matrix see = discrete_lyapunov(g.A.transpose(), g.C.transpose() * g.C);
  if (!reach.allFinite() || !see.allFinite()) return std::nullopt;
  const Matrix r = square_root(reach), l = square_root(see);
  const algebra::SingularValues svd = algebra::singular_value_decomposition(l.transpose() * r);
  const Vector& s = svd.values;
  Eigen::Index kept = 0;
  const double least = tolerance * std::max(s[0], g.D.norm());
  while (kept < s.size() && s[kept] > least) ++kept;
  const Vector scale = s.head(kept).cwiseSqrt().cwiseInverse();
  const Matrix right = r * svd.v.leftCols(kept) * scale.asDiagonal();
  const Matrix left = scale.asDiagonal() * svd.u.leftCols(kept).transpose() * l.transpose();
  return System{left * g.A * right, left * g.B, g.C * right, g.D};
}

std::optional<Integrators> split_integrators(const System& g, double tolerance) {
  const Eigen::Index n = g.states();
  Integrators parts{Matrix::Zero(g.outputs(), g.inputs()), g};
  if (n == 0) return parts;
  const Matrix shifted = g.A - Matrix::Identity(n, n);
  const algebra::SingularValues svd = algebra::singular_value_decomposition(shifted);
  const Vector& s = svd.values;
  const double size = std::max(s[0], 1e-12);
  Eigen::Index rank = 0;
  while (rank < n && s[rank] > tolerance * size) ++rank;
  if (rank == n) return parts;
  // null(A - I) beside range(A - I): the whole space where the eigenvalue 1 is semisimple.
  Matrix basis(n, n);
  basis << svd.v.rightCols(n - rank), svd.u.leftCols(rank);
  if (!well_conditioned(basis, 1e-10)) return std::nullopt;
  const Eigen::PartialPivLU<Matrix> lu(basis);
  const Matrix a = lu.solve(g.A * basis), b = lu.solve(g.B), c = g.C * basis;
  parts.residue = c.leftCols(n - rank) * b.topRows(n - rank);
  parts.rest = {a.bottomRightCorner(rank, rank), b.bottomRows(rank), c.rightCols(rank), g.D};
  return parts;
}

}  // namespace hapticd::synthesis
