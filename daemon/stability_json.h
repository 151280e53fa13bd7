// The answer of the stability check for machines.
#pragma once
#include "daemon/protocol.h"
#include "daemon/stability_gate.h"

namespace hapticd::daemon {

/// Numbers without a bound are null. Keys as in hapticctl(1), certify.
Json stability_json(const Gate& gate);

}  // namespace hapticd::daemon
