#include "control/design/check/certified.h"

#include <Eigen/Dense>
#include <cmath>

#include "control/design/check/exact.h"
#include "control/design/check/weak_convexity.h"
#include "control/design/check/weights.h"

namespace hapticd::check {
namespace {

Verdict refusal(std::string why) {
  return {false, std::move(why), 0};
}

/// X > 0 with a margin for rounding, by Cholesky; NaN fails.
bool is_positive(const Matrix& x) {
  if (x.size() == 0 || !x.allFinite()) return false;
  Matrix shifted = symmetric_part(x);
  shifted.diagonal().array() -= kStrict * shifted.norm();
  return positive_definite(shifted);
}

Matrix inverted(const Matrix& positive) {
  return symmetric_part(positive.llt().solve(Matrix::Identity(positive.rows(), positive.rows())));
}

bool is_symmetric(const Matrix& x, Eigen::Index m) {
  return x.rows() == m && x.cols() == m && x.allFinite() &&
         (x - x.transpose()).norm() <= 1e-9 * x.norm();
}

class LmiCheck {
 public:
  LmiCheck(const TiedCase& given, const Certificate& certificate, Matrix damping)
      : given_(given),
        certificate_(certificate),
        damping_(std::move(damping)),
        period_(given.plan.period_s) {}

  Verdict verdict() const {
    const std::string missing = premises();
    if (!missing.empty()) return refusal(missing);
    const Verdict scene = scene_level();
    if (!scene.holds) return scene;
    Matrix level;
    const Verdict coupling =
        given_.model.spring_damper ? closed_level(level) : general_level(level);
    if (!coupling.holds || !has_level()) return coupling;
    // (10): Phi_E below the parallel sum of the device's damping and the coupling's level.
    const double room = level_margin(scene_phi(), level, damping_);
    if (!(room > kStrict * damping_.norm()))
      return refusal(
          worded("the scene's level Phi_E is not below what device and coupling carry "
                 "together: the smallest eigenvalue of the difference is %.3g N s/m",
                 room));
    return {true, "(10) of Theorem 3 holds", room};
  }

 private:
  bool has_network_level() const { return certificate_.Phi_scene.size() > 0; }
  bool has_level() const { return has_network_level() || !given_.scene.passive(); }
  Matrix scene_phi() const {
    const Matrix weak = given_.weak_level();
    return has_network_level() ? Matrix(certificate_.Phi_scene + weak) : weak;
  }

  std::string premises() const {
    if (!given_.model.all_coupled)
      return "a network acts on a coordinate that no coupling holds: Theorem 3 needs a coupling "
             "there";
    if (std::isinf(given_.scene.weakest))
      return given_.nonconvex() + " is not convex, nor nearly; Theorem 3 is about passive scenes";
    if (given_.latency > 0 && has_level())
      return "latency and a scene that is not passive: no proof is known for both";
    if (given_.latency > period_)
      return "latency_s is longer than a period: no proof is known for a coupling then";
    return {};
  }

  Verdict scene_level() const {
    if (!has_network_level()) {
      if (given_.model.passive_network) return {true, {}, 0};
      return refusal(
          "the network is not passive by construction, and the certificate has no level "
          "Phi_scene for it");
    }
    if (!is_symmetric(certificate_.Phi_scene, damping_.rows()))
      return refusal("Phi_scene is not a symmetric matrix over the coordinates of the coupling");
    Verdict scene =
        proves_positive_real(given_.model.E, certificate_.Phi_scene, certificate_.P_scene, period_);
    if (!scene.holds) scene.why = "the scene's level Phi_scene: " + scene.why;
    return scene;
  }

  Verdict closed_level(Matrix& level) const {
    const Matrix &K = given_.model.K, &B = given_.model.B;
    if (given_.latency > 0)
      return refusal("springs and dampers under latency: see the closed form");
    if (!is_positive(K)) return refusal("the coupling's stiffness is not positive");
    if (given_.negative) return refusal("the coupling has negative damping");
    level = spring_damper_level(K, B, damping_, period_);
    if (level.size() == 0 || !is_positive(level))
      return refusal(worded("K T/2 + B < device damping fails by %.3g N s/m",
                            -smallest_eigenvalue(damping_ - 0.5 * period_ * K - B)));
    return {true, "K T/2 + B < device damping holds", 0};
  }

  Verdict general_level(Matrix& level) const {
    level = certificate_.Delta_coupling;
    if (!is_symmetric(level, damping_.rows()) || !is_positive(level))
      return refusal(
          "Delta_coupling is not a positive matrix over the coordinates of the coupling");
    const System v = yielding(given_.model.V, damping_, given_.latency, period_);
    if (Eigen::FullPivLU<Matrix>(v.D).rcond() < 1e-12)
      return refusal("the coupling's feed-through less what the device takes is singular");
    Verdict proof = proves_positive_real(inverse(v), -level, certificate_.P_coupling, period_);
    proof.why =
        (proof.holds ? "the coupling's level holds: " : "the coupling's level fails: ") + proof.why;
    return proof;
  }

  const TiedCase& given_;
  const Certificate& certificate_;
  Matrix damping_;
  double period_;
};

Verdict exact(const TiedCase& given, const Certificate& certificate, const Matrix& damping) {
  if (!given.scene.linear)
    return refusal("the exact proof is for one linear scene, and an object here is not linear");
  if (!given.needs.direct.isZero(0) || !given.needs.travel.isZero(0))
    return refusal(
        "the exact proof is for one linear scene, and something is rendered directly beside it");
  for (const std::size_t d : given.devices) {
    if (given.assumed[d].latency_s != given.latency)
      return refusal("the exact proof is for one latency, and devices that are tied have several");
  }
  const bool split = given.needs.has_observer || !given.needs.joint_damper.isZero(0) ||
                     !given.needs.direct_damper.isZero(0);
  if (given.latency > 0 && split)
    return refusal("latency, and a compensation or an observer: no proof is known for both");
  return proves_exact(given.model.F, damping, given.latency, given.plan.period_s, certificate.P);
}

}  // namespace

Matrix damping_left(const TiedCase& given, double share) {
  const Matrix beside = given.beside(direct_weight(given.latency, given.plan.period_s));
  const Matrix left = share * Matrix(given.damping.asDiagonal()) - beside;
  const Matrix j = given.coupled_jacobian();
  if (!is_positive(left) || j.rows() == 0) return {};
  const Matrix yields = symmetric_part(j * left.llt().solve(Matrix(j.transpose())));
  return is_positive(yields) ? inverted(yields) : Matrix{};
}

System yielding(const System& V, const Matrix& damping, double latency_s, double period_s) {
  const double theta = latency_s / period_s;
  const Matrix takes = 0.5 * period_s * inverted(damping);
  const System now = sum(V, constant(-(1 + theta) * takes));
  if (latency_s == 0) return now;
  return sum(now, series(constant(-theta * takes), delay(takes.rows())));
}

Certified certified(const TiedCase& given, const Certificate& certificate) {
  if (certificate.kind == CertificateKind::passive_closed_form)
    return {refusal("its certificate is the closed form"), Theorem::none};
  if (!(certificate.damping_share > 0) || !(certificate.damping_share < 1))
    return {refusal("its share of the damping is not between 0 and 1"), Theorem::none};
  if (given.model.coordinates.empty())
    return {refusal("there is neither a coupling nor a network here"), Theorem::none};
  const bool beside = !given.needs.direct.isZero(0) || !given.needs.travel.isZero(0);
  if (given.latency > 0 && beside && !given.needs.convex)
    return {refusal("latency, and an object that is rendered directly and is not convex or has "
                    "friction"),
            Theorem::none};
  const Matrix damping = damping_left(given, certificate.damping_share);
  if (damping.size() == 0)
    return {refusal("what is rendered beside the coupling leaves no damping for it"),
            Theorem::none};
  if (certificate.kind == CertificateKind::sampled_exact)
    return {exact(given, certificate, damping), Theorem::this_scene};
  if (given.latency > 0 && (given.needs.has_observer || !(given.needs.joint_damper.isZero(0) &&
                                                          given.needs.direct_damper.isZero(0))))
    return {refusal("latency, and dampers or a compensation beside the coupling: no proof is known "
                    "for both"),
            Theorem::none};
  return {LmiCheck(given, certificate, damping).verdict(), Theorem::passive_scene};
}

}  // namespace hapticd::check
