// The P of the exact sampled-data test (check/exact.h), by a Riccati solve.
#pragma once
#include "control/design/synthesis/storage.h"

namespace hapticd::synthesis {

/// A P that check::proves_exact accepts for these arguments, or why there is none.
StorageAnswer exact_certificate(const System& f, const Matrix& damping, double latency_s,
                                double period_s);

}  // namespace hapticd::synthesis
