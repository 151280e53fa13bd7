#include "control/design/synthesis/exact_certificate.h"

namespace hapticd::synthesis {

StorageAnswer exact_certificate(const System& f, const Matrix& damping, double latency_s,
                                double period_s) {
  return find_storage(check::exact_premises(f, damping, latency_s, period_s));
}

}  // namespace hapticd::synthesis
