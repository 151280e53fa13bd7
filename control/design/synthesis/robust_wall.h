// The damper of one wall that is rendered directly, by the exact loop: B_c that makes the largest J
// (exact_index.h) of all cases least, and whether the loop is then stable for all that it may be. The
// paper's own design (transmitted_search.h) stands beside it and decides nothing: where the exact loop
// fails, the design fails.
#pragma once
#include <string>
#include <vector>

#include "control/design/check/robust.h"
#include "control/design/synthesis/exact_index.h"
#include "control/design/synthesis/sampled_search.h"
#include "control/design/synthesis/transmitted_search.h"

namespace hapticd::synthesis {

struct RobustWallGoal {
  SampledWall wall;
  WallMeant meant;
  check::LoopBox box;           ///< what the loop is to be stable for
  std::vector<LoopCase> cases;  ///< what J is the largest of; none: those of the box, per_side
  int per_side = 3;
  Scan dampers{.low = 0.05, .high = 60, .points = 60};
  HoldModel hold;  ///< of the paper's design; its device is the box's middle, and its
                   ///< uncertainties half the sides
};

struct DamperDesign {
  double damper_Ns_m = 0;  ///< 0: none
  double index = 0;        ///< largest J
  LoopCase worst;          ///< whose it is
  PaperDesign paper;
  std::string why;  ///< why there is none
};
/// The damper alone.
DamperDesign design_damper(const RobustWallGoal& goal);

struct RobustWallDesign : DamperDesign {
  check::RobustAnswer robust;    ///< at that damper
  std::vector<check::Matrix> P;  ///< that prove it; common_lyapunov.h
};

/// Largest J over the cases whose contact is closed; infinity where one of all is not stable.
struct LargestIndex {
  double value = 0;
  LoopCase at;
};
LargestIndex largest_index(const SampledLoop& loop, const std::vector<LoopCase>& cases,
                           const WallMeant& meant);

/// With what proves it.
RobustWallDesign design_wall(const RobustWallGoal& goal);

}  // namespace hapticd::synthesis
