// One axis of one device being identified: the loop around control/identify. Ticks come from a
// TickClock, samples and efforts go through drivers/device.h, as in the servo thread.
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "control/core/result.h"
#include "control/identify/held_loss.h"
#include "control/identify/response.h"
#include "control/identify/runner.h"
#include "daemon/hapticctl_identify_clock.h"
#include "daemon/hapticctl_identify_setup.h"

namespace hapticd::daemon {

struct IdentifySession {
  identify::Runner runner;
  identify::Signal hand_force;  ///< N, a value a sample; empty without a force sensor
  double greatest_stray = 0;    ///< m or rad: of the axes that were held
  identify::HeldLoss held_loss;
  std::int64_t missed_ticks = 0;
};

/// How far it is, 0 to 1, and the frequency it is at.
using IdentifyProgress = std::function<void(double progress, double frequency_Hz)>;

/// Locks the device, runs the excitation from begin to end, and leaves the device without force
/// whatever happens. Errors: unavailable (the device), no (a bound was exceeded), try_again
/// (interrupted, or hapticd has the device).
Result<IdentifySession> run_session(IdentifySetup& setup, const std::atomic<bool>& interrupt,
                                    const IdentifyProgress& progress);

}  // namespace hapticd::daemon
