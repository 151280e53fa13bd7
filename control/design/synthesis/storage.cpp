#include "control/design/synthesis/storage.h"

#include <Eigen/Dense>
#include <cmath>

#include "control/design/check/balance.h"

namespace hapticd::synthesis {
namespace {

using check::balance;
using check::Dissipation;
using check::symmetric_part;
using check::Vector;

/// Distances e from the boundary that are tried, the safest first.
constexpr double kShifts[] = {1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11};
constexpr int kDoublings = 60;

/// In coordinates in which A is balanced and all columns of S and Y together are of order one.
Dissipation scaled(const Dissipation& from, const Vector& d) {
  Dissipation to;
  to.A = d.cwiseInverse().asDiagonal() * from.A * d.asDiagonal();
  to.B = d.cwiseInverse().asDiagonal() * from.B;
  to.S = from.S * d.asDiagonal();
  to.Y = from.Y * d.asDiagonal();
  to.R = from.R;
  return to;
}

/// A storage of the right size for each state alone: what can be got out of it, or, where nothing
/// can, what it costs to get there.
Vector storage_size(const Dissipation& d) {
  const double unit = d.R.norm();
  Matrix seen = d.S, stored = d.Y, reached = d.B;
  Vector out = Vector::Zero(d.A.rows()), in = out;
  for (Eigen::Index k = 0; k < d.A.rows(); ++k) {
    out += (seen.colwise().squaredNorm() / unit + stored.colwise().squaredNorm()).transpose();
    in += reached.rowwise().squaredNorm() / unit;
    seen = seen * d.A;
    stored = stored * d.A;
    reached = d.A * reached;
  }
  for (Eigen::Index i = 0; i < out.size(); ++i)
    if (!(out(i) > 0)) out(i) = in(i) > 0 ? 1 / in(i) : 1;
  return out;
}

/// What doubling came to.
struct Doubled {
  enum class End { solved, unbounded, slow } end = End::slow;
  Matrix P;
};

Doubled doubling(const Dissipation& d, double shift, const Vector& ridge) {
  const Eigen::Index n = d.A.rows();
  const Matrix identity = Matrix::Identity(n, n);
  const double keep = 1 - shift;
  const Eigen::LLT<Matrix> factor(symmetric_part(d.R));
  if (factor.info() != Eigen::Success) return {Doubled::End::unbounded, {}};
  // All of M divided by 1 - e; R stays, B and S go with the roots.
  const Matrix from_S = factor.solve(d.S) / keep;
  Matrix F = (d.A - d.B * from_S) / std::sqrt(keep);
  Matrix G = symmetric_part(d.B * factor.solve(d.B.transpose())) / keep;
  Matrix H = -symmetric_part(d.S.transpose() * from_S + d.Y.transpose() * d.Y) / keep;
  H.diagonal() -= shift * ridge;
  for (int k = 0; k < kDoublings; ++k) {
    // I + G H has the eigenvalues of I - N' G N, -H = N N'.
    const Eigen::LLT<Matrix> root(-H);
    if (root.info() != Eigen::Success || !root.matrixLLT().allFinite())
      return {Doubled::End::slow, {}};
    const Matrix N = root.matrixL();
    if (!check::positive_definite(identity - N.transpose() * G * N))
      return {Doubled::End::unbounded, {}};
    const Eigen::PartialPivLU<Matrix> lu(identity + G * H);
    const Matrix step = lu.solve(F);
    const Matrix gained = symmetric_part(F.transpose() * H * step);
    const Matrix reach = symmetric_part(F * lu.solve(G) * F.transpose());
    F = F * step;
    G += reach;
    H += gained;
    if (!H.allFinite() || !G.allFinite()) return {Doubled::End::slow, {}};
    if (gained.norm() <= 1e-14 * H.norm()) return {Doubled::End::solved, -H};
  }
  return {Doubled::End::slow, {}};
}

}  // namespace

StorageAnswer find_storage(const check::Dissipation& inequality) {
  StorageAnswer answer;
  const Eigen::Index n = inequality.A.rows();
  if (n == 0) {
    answer.verdict = check::proves(inequality, Matrix(0, 0));
    answer.why = answer.verdict.why;
    if (answer.verdict.holds) answer.P = Matrix(0, 0);
    return answer;
  }
  const Vector d = balance(inequality.A);
  const Dissipation balanced = scaled(inequality, d);
  const Matrix back = d.cwiseInverse().asDiagonal();
  const Vector ridge = storage_size(balanced);
  for (const double shift : kShifts) {
    const Doubled solution = doubling(balanced, shift, ridge);
    if (solution.end == Doubled::End::unbounded) {
      answer.why = "no storage function: the inequality fails, or holds by less than rounding";
      continue;
    }
    if (solution.end == Doubled::End::slow) {
      answer.why = "could not decide: the Riccati equation could not be solved";
      continue;
    }
    const Matrix P = symmetric_part(back * solution.P * back);
    answer.verdict = check::proves(inequality, P);
    answer.why = answer.verdict.why;
    if (answer.verdict.holds) {
      answer.P = P;
      return answer;
    }
  }
  return answer;
}

StorageAnswer find_storage(const check::Premises& premises) {
  if (!premises.problem.empty()) return {std::nullopt, premises.problem, {}};
  return find_storage(premises.inequality);
}

StorageAnswer positive_real_certificate(const System& g, const Matrix& psi, double period_s) {
  return find_storage(check::positive_real_premises(g, psi, period_s));
}

}  // namespace hapticd::synthesis
