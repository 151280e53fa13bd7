// The descent check, on which the certificate rests (see solve.h).
#pragma once
#include "control/scene/together.h"

namespace hapticd::control {

/// Is the energy of the proxies that were found at most that of the old ones, both at this tick's
/// positions? Under latency the way there costs (g/2) |y - y_last|^2_K more.
bool descends(Together& together) noexcept;

/// The old proxies stay: the coupling pulls as they are.
void stay(Together& together) noexcept;

}  // namespace hapticd::control
