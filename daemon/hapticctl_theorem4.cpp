#include "daemon/hapticctl_theorem4.h"

#include <algorithm>
#include <cstdio>

#include "config/matrices.h"
#include "control/design/check/h_infinity.h"
#include "control/design/synthesis/ccl_h_infinity.h"
#include "control/design/synthesis/transparency.h"

namespace hapticd::daemon {
namespace {

bool tell(const synthesis::CclStep& step) {
  std::fprintf(stderr, "step %d: objective %.6g, complementarity %.3g%s", step.iteration,
               step.objective, step.complementarity, step.verified ? ", verified" : "");
  if (step.merit > 0) std::fprintf(stderr, ", loop-shaping norm %.5g", step.merit);
  std::fprintf(stderr, "\n");
  return true;
}

bool only_springs(const synthesis::CclDesign& design) {
  return std::ranges::all_of(design.coupling.blocks, &synthesis::DesignedBlock::spring_damper);
}

}  // namespace

synthesis::CclDesign design_by_theorem4(const Group& group, const synthesis::Form& form,
                                        const DesignOptions& options, double period_s) {
  synthesis::HapticLoop loop = loop_of(group, period_s);
  loop.device_level *= options.damping_share;
  synthesis::CclOptions ccl;
  ccl.progress = tell;
  // The first step may take long, and nothing is told before its end.
  std::fprintf(stderr, "Theorem 4: a coupling of %td states\n", synthesis::order(form));
  if (options.aim == DesignAim::stiffest) return synthesis::design_by_ccl(loop, form, ccl);
  const Eigen::Index m = group.damping.rows();
  ccl.max_iterations = 200;
  return synthesis::design_transparent(
      loop, form,
      {.W1 = synthesis::low_pass(options.corner_rad_s, period_s, m),
       .W2 = synthesis::unweighted(m).right,
       .norm = [](const check::System& g) { return check::h_infinity(g).upper; }},
      ccl);
}

config::CouplingCertificate certificate_of(const Group& group, const synthesis::CclDesign& design) {
  const bool springs = only_springs(design);
  if (springs && group.model.passive_network)
    return {.kind = check::CertificateKind::passive_closed_form};
  config::CouplingCertificate certificate{.kind = check::CertificateKind::passive_lmi};
  if (!group.model.passive_network) {
    certificate.P_scene = config::as_rows(design.proof.P_E);
    certificate.Phi_scene = config::as_rows(design.proof.Phi_E);
  }
  if (!springs) {
    certificate.P_coupling = config::as_rows(design.proof.P_V);
    certificate.Delta_coupling = config::as_rows(design.proof.Delta_V);
  }
  return certificate;
}

}  // namespace hapticd::daemon
