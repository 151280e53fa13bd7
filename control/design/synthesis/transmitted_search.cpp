#include "control/design/synthesis/transmitted_search.h"

#include <cmath>

namespace hapticd::synthesis {

PaperDesign most_transparent_damper(const WallGoal& goal, const Scan& dampers) {
  PaperDesign design;
  design.why = malformed(goal);
  if (!design.why.empty()) return design;
  const auto value = [&](double damper) { return transparency_index(goal, damper).value; };
  const auto slope = [&](double damper) { return transparency_index(goal, damper).slope; };
  const Least found = least(value, dampers);
  if (!std::isfinite(found.value)) {
    design.why = "no damper within the scan makes the nominal loop stable and J finite";
    return design;
  }
  // Values tell the place to about 1e-6; the slope tells the rest where it changes sign near by.
  const double low = found.x * (1 - 1e-3), high = found.x * (1 + 1e-3);
  const bool inside = slope(low) < 0 && slope(high) > 0;
  design.damper_Ns_m = inside ? sign_change(slope, low, high) : found.x;
  design.answer = paper_answer(goal, design.damper_Ns_m);
  return design;
}

std::optional<Range> robust_dampers(const WallGoal& goal, const Scan& dampers) {
  if (!malformed(goal).empty()) return std::nullopt;
  const auto robust = [&](double damper) {
    return nominally_stable(goal, damper) && perturbation_norm(goal, damper) <= 1;
  };
  return where(robust, dampers);
}

std::vector<PaperRow> paper_sweep(const WallGoal& goal, const std::vector<double>& stiffnesses,
                                  const std::vector<double>& dampers) {
  std::vector<PaperRow> rows;
  WallGoal at = goal;
  for (const double stiffness : stiffnesses) {
    at.stiffness_N_m = stiffness;
    for (const double damper : dampers)
      rows.push_back({stiffness, damper, paper_answer(at, damper)});
  }
  return rows;
}

}  // namespace hapticd::synthesis
