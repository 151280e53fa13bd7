#include "control/design/synthesis/theorem3.h"

#include <Eigen/Dense>
#include <cmath>

#include "control/design/check/dissipation.h"
#include "control/design/synthesis/balance.h"
#include "control/design/synthesis/lmi_levels.h"
#include "control/design/synthesis/storage.h"

namespace hapticd::synthesis {

Matrix stability_matrix(const Matrix& device, const Matrix& phi, const Matrix& delta) {
  Matrix whole(2 * phi.rows(), 2 * phi.rows());
  whole << device - phi, -phi, -phi, delta - phi;
  return whole;
}

namespace {

constexpr double kSymmetry = 1e-8;  ///< relative: asymmetry that a computed G(1) may have

struct Side {
  std::string why;  ///< it has no level at all
  System small;     ///< without integrator, in units of the device's level, balanced
  Matrix rest;      ///< G(1)
};

Side prepare(const System& g, double period_s, double unit) {
  Side side;
  if (!g.A.allFinite() || !g.B.allFinite() || !g.C.allFinite() || !g.D.allFinite()) {
    side.why = "is not finite";
    return side;
  }
  if (!(check::spectral_radius(g.A) < 1)) {
    side.why = "has a pole that is not inside the unit circle";
    return side;
  }
  side.rest = check::at_rest(g);
  const double size = std::max(side.rest.norm(), g.D.norm());
  if ((side.rest - side.rest.transpose()).norm() > kSymmetry * size) {
    side.why = "is not symmetric at rest";
    return side;
  }
  if (check::smallest_eigenvalue(side.rest) < -kSymmetry * size) {
    side.why = "is negative at rest";
    return side;
  }
  const auto small = balanced(check::scaled(without_integrator(g, period_s), 1 / unit));
  if (!small) {
    side.why = "is too lightly damped to be told from an unstable one";
    return side;
  }
  side.small = *small;
  return side;
}

std::vector<double> worst_at_rest(const Matrix& rest) {
  std::vector<double> share(static_cast<std::size_t>(rest.rows()), 0);
  if (rest.rows() == 0 || !rest.allFinite()) return share;
  Eigen::Index worst = 0;
  algebra::symmetric_eigen(rest).vectors.col(0).cwiseAbs().maxCoeff(&worst);
  share[static_cast<std::size_t>(worst)] = 1;
  return share;
}

std::vector<double> shares(const Matrix& multiplier, Eigen::Index m) {
  std::vector<double> share(static_cast<std::size_t>(m), 0);
  double sum = 0;
  for (Eigen::Index i = 0; i < m; ++i) sum += std::max(multiplier(i, i), 0.0);
  for (Eigen::Index i = 0; i < m && sum > 0; ++i) {
    share[static_cast<std::size_t>(i)] = std::max(multiplier(i, i), 0.0) / sum;
  }
  return share;
}

/// The program of the header, in units of `unit`; leaves margin, levels and shares in `result`.
void largest_margin(const Side& scene, const Side& coupling, const HapticLoop& loop, double unit,
                    const Theorem3Options& options, Theorem3& result) {
  const Eigen::Index m = loop.device_level.rows();
  const Matrix one = Matrix::Identity(m, m), device = loop.device_level / unit;
  Lmi lmi;
  const Affine pe = lmi.symmetric(scene.small.states()),
               pv = lmi.symmetric(coupling.small.states());
  const Affine phi = lmi.symmetric(m), delta = lmi.symmetric(m), t = lmi.scalar();
  lmi.at_least(passive_matrix(scene.small, pe, -1.0 * phi));
  lmi.at_least(passive_matrix(coupling.small, pv, delta));
  Affine margin = symmetric_blocks({{Affine(device) - phi, -1.0 * phi}, {delta - phi}});
  for (Eigen::Index i = 0; i < 2 * m; ++i) margin.add(t.terms().front().variable, i, i, -1);
  const std::size_t ten = lmi.at_least(margin);
  lmi.at_least(Affine(options.level_cap_Ns_m / unit * one) - delta);
  lmi.minimise(-Matrix::Identity(1, 1), t);
  const SdpAnswer answer = lmi.solve({.gap = options.gap});
  result.decided = answer.solved;
  if (!answer.solved) {
    result.why = "the solver found no levels: " + answer.why;
    return;
  }
  result.margin_Ns_m = unit * t.at(answer.x)(0, 0);
  // A part of the margin goes into the levels, so that P_E and P_V have room: (10) loses at most
  // (3 + sqrt 5)/2 of it.
  const double room = std::max(result.margin_Ns_m, 0.0) / 8;
  result.Phi_E = unit * phi.at(answer.x) + room * one;
  result.Delta_V = unit * delta.at(answer.x) - room * one;
  result.limits = shares(answer.multipliers[ten], m);
  if (!(result.margin_Ns_m > 0)) result.why = "no levels satisfy (10)";
}

void verify(const HapticLoop& loop, const System& backed_off, Theorem3& result) {
  const auto pe = positive_real_certificate(loop.scene, result.Phi_E, loop.period_s);
  const auto pv = positive_real_certificate(backed_off, -result.Delta_V, loop.period_s);
  if (!pe.P || !pv.P) {
    result.decided = false;
    result.why = pe.P ? "the coupling's level could not be verified: " + pv.why
                      : "the scene's level could not be verified: " + pe.why;
    return;
  }
  result.P_E = *pe.P;
  result.P_V = *pv.P;
  const Matrix ten = stability_matrix(loop.device_level, result.Phi_E, result.Delta_V);
  result.stable = check::positive_definite(ten);
  if (!result.stable) result.why = "(10) could not be verified";
}

}  // namespace

Theorem3 theorem3(const HapticLoop& loop, const System& coupling, const Theorem3Options& options) {
  Theorem3 result;
  const double unit = loop.device_level.trace() / static_cast<double>(loop.device_level.rows());
  if (!(check::smallest_eigenvalue(loop.device_level) > 0)) {
    result.why = "the device has no damping";
    return result;
  }
  const Side scene = prepare(loop.scene, loop.period_s, unit);
  result.decided = true;
  result.limits.assign(static_cast<std::size_t>(loop.device_level.rows()), 0);
  if (!scene.why.empty()) {
    result.why = "the scene " + scene.why;
    return result;
  }
  if (!(check::spectral_radius(coupling.A) < 1)) {
    result.why = "the coupling has a pole that is not inside the unit circle";
    return result;
  }
  const System backed_off = backed_off_inverse(coupling, loop);
  const Matrix softness = check::at_rest(coupling) - half_compliance(loop);
  const Side side = prepare(backed_off, loop.period_s, unit);
  if (!side.why.empty()) {
    result.why = "V-hat has no level: (V - kappa)^-1 " + side.why;
    result.limits = worst_at_rest(check::symmetric_part(softness));
    return result;
  }
  largest_margin(scene, side, loop, unit, options, result);
  if (result.margin_Ns_m > 0) verify(loop, backed_off, result);
  return result;
}

}  // namespace hapticd::synthesis
