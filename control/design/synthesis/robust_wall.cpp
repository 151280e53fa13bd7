#include "control/design/synthesis/robust_wall.h"

#include <cmath>
#include <cstdio>
#include <limits>

#include "control/design/synthesis/common_search.h"

namespace hapticd::synthesis {
namespace {

double middle(const check::Side& side) {
  return 0.5 * (side.low + side.high);
}
/// Half the length, as a share of the middle.
double spread(const check::Side& side) {
  return middle(side) > 0 ? 0.5 * (side.high - side.low) / middle(side) : 0;
}

WallGoal paper_goal(const RobustWallGoal& goal) {
  return {.mass_kg = middle(goal.box.mass_kg),
          .damping_Ns_m = middle(goal.box.damping_Ns_m),
          .mass_uncertainty = spread(goal.box.mass_kg),
          .damping_uncertainty = spread(goal.box.damping_Ns_m),
          .stiffness_N_m = goal.wall.stiffness_N_m,
          .wall_damping_Ns_m = goal.meant.damping_Ns_m,
          .period_s = goal.wall.period_s,
          .hold = goal.hold,
          .weight = goal.meant.weight};
}

/// Where the loop comes nearest to being stable in all cases, and which one is not.
std::string nearest(const RobustWallGoal& goal, const std::vector<LoopCase>& cases) {
  const auto radius = [&](double damper) {
    return check::worst_of(loop_of(goal.wall, damper), cases).radius;
  };
  const Least best = least(radius, goal.dampers);
  const check::WorstCase worst = check::worst_of(loop_of(goal.wall, best.x), cases);
  char text[160];
  std::snprintf(
      text, sizeof text,
      "no damper makes the sampled loop stable in all %zu cases; nearest is %.4g N s/m, whose "
      "largest eigenvalue is %.6g at ",
      cases.size(), best.x, worst.radius);
  return text + check::described(worst.at);
}

}  // namespace

LargestIndex largest_index(const SampledLoop& loop, const std::vector<LoopCase>& cases,
                           const WallMeant& meant) {
  LargestIndex largest;
  for (const LoopCase& one : cases) {
    double index = 0;
    if (one.contact == 1) {
      index = exact_index(loop, one, meant);
    } else if (!(check::loop_radius(loop, one) < 1)) {
      index = std::numeric_limits<double>::infinity();
    }
    if (!(index <= largest.value)) largest = {index, one};
    if (!std::isfinite(index)) break;
  }
  return largest;
}

DamperDesign design_damper(const RobustWallGoal& goal) {
  DamperDesign design;
  const SampledLoop sample = loop_of(goal.wall, goal.dampers.low);
  design.why = check::malformed(sample, goal.box);
  const WallGoal paper = paper_goal(goal);
  if (design.why.empty()) design.why = malformed(paper);
  if (!design.why.empty()) return design;
  design.paper = most_transparent_damper(paper, goal.dampers);
  const std::vector<LoopCase> box = check::cases_of(goal.box, goal.per_side);
  const std::vector<LoopCase>& cases = goal.cases.empty() ? box : goal.cases;
  const auto largest = [&](double damper) {
    const SampledLoop loop = loop_of(goal.wall, damper);
    if (!goal.cases.empty() && !check::all_stable(loop, box))
      return std::numeric_limits<double>::infinity();
    return largest_index(loop, cases, goal.meant).value;
  };
  const Least best = least(largest, goal.dampers);
  if (!std::isfinite(best.value)) {
    design.why = nearest(goal, box);
    return design;
  }
  const SampledLoop loop = loop_of(goal.wall, best.x);
  design.damper_Ns_m = best.x;
  design.index = best.value;
  design.worst = largest_index(loop, cases, goal.meant).at;
  return design;
}

RobustWallDesign design_wall(const RobustWallGoal& goal) {
  RobustWallDesign design{design_damper(goal), {}, {}};
  if (!design.why.empty()) return design;
  const SampledLoop loop = loop_of(goal.wall, design.damper_Ns_m);
  design.P = find_common(loop, goal.box).P;
  if (design.P.empty()) design.P = find_constant(loop, goal.box).P;
  design.robust = check::robust(loop, goal.box, design.P, goal.per_side);
  return design;
}

}  // namespace hapticd::synthesis
