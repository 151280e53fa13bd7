// What a coupling file may carry to prove what no closed form proves, and what is checked of it at
// load, by Eigen alone. Coordinates are those that the coupling names, in plan order, m of them.
#pragma once
#include "control/design/check/certificate_kind.h"
#include "control/design/check/linear.h"

namespace hapticd::check {

struct Certificate {
  CertificateKind kind = CertificateKind::passive_closed_form;
  double damping_share = 0.98;  ///< share of the device's damping that the proof may use, < 1
  /// passive_lmi. Level of the scene, E + Phi_E passive; empty where the scene is passive by
  /// construction. P_scene proves it (positive_real.h).
  Matrix P_scene, Phi_scene;
  /// passive_lmi with a general V(z): its level and what proves it. Empty for springs and dampers.
  Matrix P_coupling, Delta_coupling;
  /// sampled_exact: order of F, with latency m more.
  Matrix P;
};

}  // namespace hapticd::check
