// `hapticctl sweep CONFIG --over WHAT -o FILE.csv`: curves of the one wall of a config, the paper's figures beside those
// of the sampled loop, for `plot`.
#pragma once
#include <optional>
#include <string>

#include "control/core/result.h"

namespace hapticd::daemon {

enum class SweepOver {
  damping,    ///< of the wall's controller, B_c: index J, norm |L|, largest eigenvalue
  stiffness,  ///< the same over K
  frequency,  ///< admittance of the wall that is meant and of the one that is transmitted
};

struct SweepOptions {
  SweepOver over = SweepOver::damping;
  std::string output;   ///< CSV
  std::string picture;  ///< .png or .svg; empty: none
  std::optional<double> from, to;
  int points = 200;
};

/// Errors: bad_data (no wall on one axis), usage, try_again (interrupted).
ExitCode run_sweep(const std::string& path, const SweepOptions& options, bool json);

}  // namespace hapticd::daemon
