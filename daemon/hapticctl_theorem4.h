// `design --proof paper`: a coupling by Theorem 4, and the certificate that its file carries.
#pragma once
#include "config/schema_coupling.h"
#include "control/design/synthesis/ccl.h"
#include "daemon/hapticctl_designer.h"
#include "daemon/hapticctl_groups.h"

namespace hapticd::daemon {

/// By cone complementarity: the first iterate that Theorem 3 proves, or of all of them the most
/// transparent. Steps are told on standard error.
synthesis::CclDesign design_by_theorem4(const Group& group, const synthesis::Form& form,
                                        const DesignOptions& options, double period_s);

/// What proves it at load: a closed form where springs and dampers face a network that is passive by
/// construction, else the levels and storages of Theorem 3.
config::CouplingCertificate certificate_of(const Group& group, const synthesis::CclDesign& design);

}  // namespace hapticd::daemon
