// The solvers behind sdp.h. A problem is sound when it gets here.
#pragma once
#include "control/design/synthesis/sdp.h"

namespace hapticd::synthesis {

SdpAnswer solve_dsdp(const SdpProblem& problem, const SdpOptions& options);
SdpAnswer solve_sdpa(const SdpProblem& problem, const SdpOptions& options);

#ifdef HAPTICD_WITH_SDPA
inline constexpr bool kHasSdpa = true;
#else
inline constexpr bool kHasSdpa = false;
inline SdpAnswer solve_sdpa(const SdpProblem&, const SdpOptions&) {
  return {};
}
#endif

/// While it lives, OpenBLAS (if that is the BLAS) uses one thread: small matrices gain nothing from
/// more, and sums keep their order.
class OneBlasThread {
 public:
  OneBlasThread();
  ~OneBlasThread();
  OneBlasThread(const OneBlasThread&) = delete;
  OneBlasThread& operator=(const OneBlasThread&) = delete;

 private:
  int before_ = 0;  ///< 0: another BLAS
};

}  // namespace hapticd::synthesis
