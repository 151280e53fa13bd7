// The loop as it will run, with forces off, watched for a while.
#pragma once
#include <atomic>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/doctor.h"
#include "daemon/realtime.h"

namespace hapticd::daemon {

struct Measured {
  LoopTimes times;
  RealtimeReport rights;  ///< what the loop got of what it asked for
};

/// Connects and locks the devices of the config, runs its loop for `seconds` of real time, leaves
/// the devices without force. Ends early when `interrupt` becomes true. Errors: of devices that
/// cannot be reached or that another hapticd holds.
Result<Measured> measure(config::Compiled& compiled, double seconds,
                         const std::atomic<bool>& interrupt);

/// Wake-ups alone, 1000 a second.
Measured measure_wake_ups(int priority, double seconds, const std::atomic<bool>& interrupt);

}  // namespace hapticd::daemon
