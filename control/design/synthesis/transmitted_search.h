// Searches over the wall's damper (and stiffness) in the paper's model (transmitted.h): the paper's
// own recursion, the minimum of J first and (17) after it.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "control/design/synthesis/one_variable.h"
#include "control/design/synthesis/transmitted.h"

namespace hapticd::synthesis {

struct PaperDesign {
  double damper_Ns_m = 0;  ///< argmin of J; 0: none
  PaperAnswer answer;      ///< there
  std::string why;         ///< why there is none
};
PaperDesign most_transparent_damper(const WallGoal& goal, const Scan& dampers = {});

/// B_c that (17) and nominal stability allow.
std::optional<Range> robust_dampers(const WallGoal& goal, const Scan& dampers = {});

struct PaperRow {
  double stiffness_N_m = 0, damper_Ns_m = 0;
  PaperAnswer answer;
};
/// Every stiffness with every damper.
std::vector<PaperRow> paper_sweep(const WallGoal& goal, const std::vector<double>& stiffnesses,
                                  const std::vector<double>& dampers);

}  // namespace hapticd::synthesis
