// What a push of constant force on a wall does: measured on any source of positions and forces.
#pragma once
#include <cstddef>
#include <vector>

namespace hapticd::test {

/// One run. Positions at the ends of all sub-steps after the push began, forces at ticks (positive:
/// out of the wall).
struct StepResponse {
  double substep_s = 0;
  std::vector<double> position_m;
  std::vector<double> force_N;
};

struct StepFigures {
  double overshoot_pct = 0;       ///< over `expected_m`, at sub-steps
  double tick_overshoot_pct = 0;  ///< at the ticks only
  double settle_ms = 0;           ///< until within 2 % of `expected_m` for good
  double steady_m = 0;            ///< mean of the last tenth
  double peak_N = 0;
};

StepFigures figures(const StepResponse& response, std::size_t substeps, double expected_m);

}  // namespace hapticd::test
