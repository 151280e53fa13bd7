#include "control/design/synthesis/lmi_levels.h"

#include <Eigen/Dense>
#include <algorithm>

#include "control/design/synthesis/balance.h"

namespace hapticd::synthesis {

Matrix lemma1(const System& g, const Matrix& p, const Matrix& delta, const Matrix& phi) {
  const Eigen::Index n = g.states(), m = g.inputs();
  Matrix l(n + m, n + m);
  const Matrix corner =
      0.5 * g.C.transpose() - g.A.transpose() * p * g.B - g.C.transpose() * delta * g.D;
  l << p - g.A.transpose() * p * g.A - g.C.transpose() * delta * g.C, corner, corner.transpose(),
      check::symmetric_part(g.D) - g.B.transpose() * p * g.B - g.D.transpose() * delta * g.D - phi;
  return l;
}

Matrix lemma2(const System& g, const Matrix& q, const Matrix& delta, const Matrix& phi) {
  const Eigen::Index n = g.states(), m = g.inputs();
  Matrix r(n + 2 * m, n), s = Matrix::Zero(n + 2 * m, n + 2 * m);
  r << 0.5 * g.C, g.A, g.C;
  s.topRows(m) << check::symmetric_part(g.D) - phi, g.B.transpose(), g.D.transpose();
  s.block(m, 0, n, m) = g.B;
  s.bottomLeftCorner(m, m) = g.D;
  s.block(m, m, n, n) = q;
  s.bottomRightCorner(m, m) = delta.inverse();
  Matrix whole(2 * n + 2 * m, 2 * n + 2 * m);
  whole << q.inverse(), r.transpose(), r, s;
  return whole;
}

Affine passive_matrix(const System& g, const Affine& p, const Affine& phi) {
  const Matrix at = g.A.transpose(), bt = g.B.transpose();
  return symmetric_blocks({{p - at * p * g.A, Affine(Matrix(0.5 * g.C.transpose())) - at * p * g.B},
                           {Affine(check::symmetric_part(g.D)) - bt * p * g.B - phi}});
}

namespace {

Affine level_of(Lmi& lmi, Eigen::Index size, LevelShape shape) {
  if (shape == LevelShape::isotropic) return lmi.isotropic(size);
  if (shape == LevelShape::full) return lmi.symmetric(size);
  Pattern pattern = Pattern::Constant(size, size, false);
  pattern.diagonal().setConstant(true);
  return lmi.symmetric(pattern);
}

// What the residue may lack to be symmetric and >= 0, relative: roundoff of the split.
constexpr double kResidueTolerance = 1e-9;

std::string unfit(const Matrix& residue, double size) {
  if ((residue - residue.transpose()).cwiseAbs().maxCoeff() > kResidueTolerance * size) {
    return "its residue at z = 1 is not symmetric";
  }
  if (check::smallest_eigenvalue(residue) < -kResidueTolerance * size) {
    return "its residue at z = 1 is not positive";
  }
  return {};
}

Level stable_level(const System& g, LevelShape shape) {
  Level result;
  Lmi lmi;
  const Affine p = lmi.symmetric(g.states()), phi = level_of(lmi, g.inputs(), shape);
  lmi.at_least(passive_matrix(g, p, phi));
  if (g.states() > 0) lmi.at_least(p);
  lmi.minimise(-Matrix::Identity(g.inputs(), g.inputs()), phi);
  const SdpAnswer answer = lmi.solve();
  result.found = answer.solved;
  result.why = answer.why;
  if (answer.solved) result.level = phi.at(answer.x);
  return result;
}

}  // namespace

Level lmi_input_level(const System& g, LevelShape shape) {
  Level result;
  if (g.inputs() != g.outputs() || g.inputs() == 0) {
    result.why = "as many outputs as inputs are needed";
    return result;
  }
  if (!g.A.allFinite() || !g.B.allFinite() || !g.C.allFinite() || !g.D.allFinite()) {
    result.why = "its matrices are not finite";
    return result;
  }
  const auto parts = split_integrators(g);
  if (!parts) {
    result.why = "it has a double integrator";
    return result;
  }
  const double size =
      std::max({g.D.cwiseAbs().maxCoeff(), parts->residue.cwiseAbs().maxCoeff(), 1e-300});
  result.why = unfit(parts->residue, size);
  if (!result.why.empty()) return result;
  System rest = parts->rest;
  rest.D -= 0.5 * check::symmetric_part(parts->residue);
  const auto small = balanced(check::scaled(rest, 1 / size));
  if (!small) {
    result.why = "it is not stable";
    return result;
  }
  result = stable_level(*small, shape);
  if (result.found) result.level *= size;
  return result;
}

Level lmi_output_level(const System& g, LevelShape shape) {
  if (g.inputs() != g.outputs() || !well_conditioned(g.D, 1e-14)) {
    Level result;
    result.why = "its feed-through D is singular";
    return result;
  }
  return lmi_input_level(check::inverse(g), shape);
}

}  // namespace hapticd::synthesis
