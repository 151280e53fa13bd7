#include "control/design/check/dissipation.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace hapticd::check {
namespace {

constexpr double kRoundoff = std::numeric_limits<double>::epsilon();  // 2 u
/// G(1) of models that were themselves computed: how far from symmetric and >= 0 it may be,
/// relative to the terms it is the sum of.
constexpr double kRestTolerance = 1e-10;

std::string figures(const char* format, double a, double b) {
  char text[240];
  std::snprintf(text, sizeof text, format, a, b);
  return text;
}

Matrix or_zero(const Matrix& error, const Matrix& of) {
  return error.size() == 0 ? Matrix(Matrix::Zero(of.rows(), of.cols())) : error;
}

/// (1) in the coordinates in which P is the identity, and how far rounding may have moved it.
struct Scaled {
  Matrix M;
  double delta = 0;
};

/// `q` with z' L' = q, so z = L^-1 q', and its error.
struct Solved {
  Matrix z, error;
};

Solved solve(const Matrix& L, const Matrix& skeel, const Matrix& inverse, const Matrix& q,
             const Matrix& error_q) {
  const double n = static_cast<double>(L.rows()) + 2;
  Solved s;
  s.z = L.triangularView<Eigen::Lower>().solve(q);
  s.error = n * kRoundoff * (skeel * s.z.cwiseAbs()) + inverse * error_q;
  return s;
}

/// Powers of two that bring the diagonal of R near one.
Vector input_scale(const Matrix& R) {
  Vector scale = Vector::Ones(R.rows());
  for (Eigen::Index i = 0; i < R.rows(); ++i)
    if (R(i, i) > 0) scale(i) = std::exp2(-std::round(0.5 * std::log2(R(i, i))));
  return scale;
}

Scaled scale(const Dissipation& d, const Matrix& L) {
  const Eigen::Index n = d.A.rows(), m = d.R.rows();
  const double length = static_cast<double>(n + m) + 2;
  const Matrix abs_L = L.cwiseAbs();
  const Matrix identity = Matrix::Identity(n, n);
  const Matrix inverse = Matrix(L.triangularView<Eigen::Lower>().solve(identity)).cwiseAbs();
  const Matrix skeel = inverse * abs_L;

  // A' L is what the triangular system is solved for, so A appears transposed: a = (L' A L'^-1)'.
  const Matrix abs_A = d.A.cwiseAbs();
  const Solved a = solve(L, skeel, inverse, d.A.transpose() * L,
                         length * kRoundoff * (abs_A.transpose() * abs_L));
  const Vector unit = input_scale(d.R);
  const Matrix b = L.transpose() * d.B * unit.asDiagonal();
  const Matrix error_b = abs_L.transpose() *
                         (or_zero(d.error_B, d.B) + length * kRoundoff * d.B.cwiseAbs()) *
                         unit.asDiagonal();
  const Solved s =
      solve(L, skeel, inverse, d.S.transpose() * unit.asDiagonal(), Matrix::Zero(n, m));
  const Solved y = solve(L, skeel, inverse, d.Y.transpose(), or_zero(d.error_Y, d.Y).transpose());
  const Matrix R = unit.asDiagonal() * symmetric_part(d.R) * unit.asDiagonal();
  const Matrix error_R = unit.asDiagonal() * or_zero(d.error_R, d.R) * unit.asDiagonal();

  Scaled result;
  result.M.resize(n + m, n + m);
  result.M.topLeftCorner(n, n) = identity - a.z * a.z.transpose() - y.z * y.z.transpose();
  result.M.topRightCorner(n, m) = s.z - a.z * b;
  result.M.bottomLeftCorner(m, n) = result.M.topRightCorner(n, m).transpose();
  result.M.bottomRightCorner(m, m) = R - b.transpose() * b;

  const double A = a.z.norm(), B = b.norm(), Y = y.z.norm(), dA = a.error.norm(),
               dB = error_b.norm(), dY = y.error.norm();
  const double carried = 2 * A * dA + 2 * Y * dY + 2 * s.error.norm() + 2 * A * dB + 2 * dA * B +
                         2 * B * dB + error_R.norm();
  const double own = std::sqrt(static_cast<double>(n)) + A * A + Y * Y + 2 * s.z.norm() +
                     2 * A * B + R.norm() + B * B;
  result.delta = 2 * carried + 2 * length * kRoundoff * own;
  return result;
}

/// Sizes that do not fit together; empty: they do.
std::string unfit(const Dissipation& d) {
  const Eigen::Index n = d.A.rows(), m = d.R.rows();
  const bool fit = m > 0 && d.A.cols() == n && d.B.rows() == n && d.B.cols() == m &&
                   d.S.rows() == m && d.S.cols() == n && d.R.cols() == m && d.Y.cols() == n;
  return fit ? "" : "there is no inequality to prove: its matrices do not fit together";
}

}  // namespace

bool positive_definite(const Matrix& m) {
  if (m.rows() != m.cols() || !m.allFinite()) return false;
  const Eigen::LLT<Matrix> factor(m);
  return factor.info() == Eigen::Success && factor.matrixLLT().allFinite();
}

std::string malformed(const System& g) {
  const Eigen::Index n = g.A.rows(), m = g.D.cols();
  const bool sizes = g.A.cols() == n && g.B.rows() == n && g.B.cols() == m && g.C.cols() == n &&
                     g.C.rows() == m && g.D.rows() == m && m > 0;
  if (!sizes) return "the system's matrices do not fit together, or it is not square";
  const bool finite = g.A.allFinite() && g.B.allFinite() && g.C.allFinite() && g.D.allFinite();
  return finite ? "" : "the system has an entry that is not a finite number";
}

std::string malformed(const Matrix& symmetric, Eigen::Index m, const char* name) {
  if (symmetric.rows() != m || symmetric.cols() != m)
    return std::string(name) +
           figures(" must have %.0f rows and columns, has ", static_cast<double>(m), 0) +
           figures("%.0f x %.0f", static_cast<double>(symmetric.rows()),
                   static_cast<double>(symmetric.cols()));
  if (!symmetric.allFinite())
    return std::string(name) + " has an entry that is not a finite number";
  // Relative to the diagonal entries of row and column, so that units do not matter.
  for (Eigen::Index i = 0; i < m; ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      const double size = std::max({std::sqrt(std::abs(symmetric(i, i) * symmetric(j, j))),
                                    std::abs(symmetric(i, j)), std::abs(symmetric(j, i))});
      if (std::abs(symmetric(i, j) - symmetric(j, i)) > 1e-12 * size)
        return std::string(name) + figures(" is not symmetric: %.9g across from %.9g",
                                           symmetric(i, j), symmetric(j, i));
    }
  }
  return {};
}

Verdict proves(const Dissipation& inequality, const Matrix& P) {
  Verdict verdict;
  verdict.margin = -std::numeric_limits<double>::infinity();
  verdict.why = unfit(inequality);
  if (verdict.why.empty()) verdict.why = malformed(P, inequality.A.rows(), "P");
  if (!verdict.why.empty()) return verdict;
  const Eigen::LLT<Matrix> factor(symmetric_part(P));
  const Matrix L = factor.matrixL();
  if (factor.info() != Eigen::Success || !L.allFinite()) {
    verdict.why = "P is not positive definite";
    return verdict;
  }
  const Scaled scaled = scale(inequality, L);
  if (!scaled.M.allFinite() || !std::isfinite(scaled.delta)) {
    verdict.why = "P is too badly conditioned: the inequality cannot be evaluated";
    return verdict;
  }
  const Eigen::Index size = scaled.M.rows();
  verdict.holds = positive_definite(scaled.M - scaled.delta * Matrix::Identity(size, size));
  const double smallest = smallest_eigenvalue(scaled.M);
  verdict.margin = smallest - scaled.delta;
  verdict.why =
      figures(verdict.holds ? "P proves it: smallest eigenvalue %.3g, rounding below %.3g"
                            : "P does not prove it: smallest eigenvalue %.3g, must exceed %.3g",
              smallest, scaled.delta);
  return verdict;
}

Rest rest(const System& g) {
  const Eigen::Index n = g.states();
  const double length = static_cast<double>(n) + 2;
  Rest r;
  const Matrix resolvent = Matrix::Identity(n, n) - g.A;
  Matrix inverse = Matrix::Zero(n, n);
  if (n > 0) {
    const Eigen::PartialPivLU<Matrix> lu(resolvent);
    inverse = lu.inverse().cwiseAbs();
    r.x = lu.solve(g.B);
    r.x += lu.solve(g.B - resolvent * r.x);
  } else {
    r.x = g.B;
  }
  if (!inverse.allFinite() || !r.x.allFinite()) {
    r.problem = "the system has a pole at z = 1";
    return r;
  }
  const Matrix residual =
      (g.B - resolvent * r.x).cwiseAbs() +
      length * kRoundoff * (resolvent.cwiseAbs() * r.x.cwiseAbs() + g.B.cwiseAbs());
  r.error_x = inverse * residual;
  r.gain = symmetric_part(g.D + g.C * r.x);
  const Matrix terms = g.D.cwiseAbs() + g.C.cwiseAbs() * r.x.cwiseAbs();
  r.error_gain = g.C.cwiseAbs() * r.error_x + length * kRoundoff * terms;

  const double size = terms.norm();
  const double tolerance = r.error_gain.norm() + kRestTolerance * size;
  const double asymmetry = (g.D + g.C * r.x - r.gain).norm();
  const Matrix identity = Matrix::Identity(r.gain.rows(), r.gain.cols());
  if (!(asymmetry <= tolerance)) {
    r.problem =
        figures("G(1) is not symmetric: off by %.3g, rounding explains %.3g", asymmetry, tolerance);
  } else if (size > 0 && !positive_definite(r.gain + 2 * tolerance * identity)) {
    r.problem = figures("G(1) has the negative eigenvalue %.6g: a spring that pushes",
                        smallest_eigenvalue(r.gain), 0);
  } else if (!(tolerance <= 1e-6 * size) && size > 0) {
    r.problem = "the system has a pole too close to z = 1 for anything to be decided";
  }
  return r;
}

}  // namespace hapticd::check
