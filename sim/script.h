// The script of the hand on one axis: force held from step to step, rest position of its spring
// linear between steps. Times are rounded to sub-steps, so that the plant's propagators can all be
// made at set-up.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/options.h"

namespace hapticd::sim {

/// The hand over one sub-step.
struct ScriptValue {
  double force_N = 0;        ///< held
  double rest_m = 0;         ///< when the sub-step begins
  double rest_rate_m_s = 0;  ///< held
};

class Script {
 public:
  /// Until the script's clock starts the hand is at rest at `start_m`; from there it goes to the
  /// first step.
  Script(const std::vector<ScriptStep>& steps, double start_m, double substep_s);

  /// For the sub-step that begins `substep` sub-steps after the clock started (negative: before).
  /// Within one run of the clock `substep` never falls.
  ScriptValue at(std::int64_t substep) noexcept;
  /// The clock will start anew.
  void restart() noexcept { current_ = 0; }

 private:
  struct Point {
    std::int64_t substep = 0;
    double force_N = 0;
    double rest_m = 0;
    double rate_m_s = 0;  ///< from here to the next point
  };
  std::vector<Point> points_;
  std::size_t current_ = 0;
};

}  // namespace hapticd::sim
