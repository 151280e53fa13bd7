// `hapticctl zwidth CONFIG -o FILE.csv`: how stiff the wall of a config may be for each damping of it. Measured, by
// pressing against walls, and beside it what the exact loop, the robust answer, the paper, the passivity proof and
// Colgate's line say.
#pragma once
#include <optional>
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

struct ZwidthOptions {
  std::string output;             ///< CSV
  std::string picture;            ///< .png or .svg; empty: none
  std::optional<double> to_Ns_m;  ///< greatest damping; default: 2 m/T
  int points = 21;
  std::optional<double> push_N;   ///< simulated hand; default: a hundredth of the greatest force
  std::optional<double> force_N;  ///< of a real device: greatest force on the way
  double travel_m = 0.02;
  double tremor_m = 5e-4;  ///< of a real device: motion that is the operator's
  bool consent = false;    ///< somebody holds the device and wants it shaken
  bool real_time = false;  ///< by the clock, whatever the driver
};

/// Errors: bad_data (no wall on one axis), usage, no (a real device without consent), unavailable, try_again
/// (interrupted, or hapticd has the device). Nothing is written unless all is known.
ExitCode run_zwidth(const std::string& path, const ZwidthOptions& options, bool json);

}  // namespace hapticd::daemon
