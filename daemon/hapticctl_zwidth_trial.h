// One point of a Z-width: a wall of one stiffness and damping on one axis, pressed against, and whether it is stable.
// The daemon's own tick, in virtual time for simulated devices, by the clock for others.
#pragma once
#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/hapticctl_identify_clock.h"
#include "drivers/device.h"

namespace hapticd::daemon {

/// The devices of a config, and the clock that they are run by.
struct ZwidthRig {
  std::vector<std::unique_ptr<drivers::Device>> devices;
  std::unique_ptr<TickClock> clock;
  bool by_the_clock = false;  ///< else in virtual time
};

struct TrialOptions {
  std::size_t axis = 0;        ///< whose position is watched
  std::size_t coordinate = 0;  ///< whose force tells the contact
  double settle_s = 0.15;      ///< from full force until the wall is knocked, in simulation
  double watch_s = 1.5;        ///< from then on
  double floor_m = 0;          ///< motion that is none: peak to peak
  double travel_m = 0;         ///< further from where the watch begins: unstable at once
};

/// What was seen over a quarter of a second in the middle and at the end of the watch.
struct Trial {
  bool stable = false;
  bool touched = false;             ///< the wall was felt at all
  double middle_m = 0, last_m = 0;  ///< motion, peak to peak
  std::string why;                  ///< of what is not stable
};

/// Not stable: a fault, motion beyond the bound, the contact opens at the end of the watch, or motion that goes to and
/// fro is above the floor then and has not become less since the middle. Ends with zero force, whatever happens.
/// Errors: unavailable (no power stage), try_again (interrupted).
Result<Trial> run_trial(build::Program& program, ZwidthRig& rig, const TrialOptions& options,
                        const std::atomic<bool>& interrupt);

}  // namespace hapticd::daemon
