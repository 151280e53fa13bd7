#include "control/design/synthesis/sampled_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::synthesis {

SampledLoop loop_of(const SampledWall& wall, double damper_Ns_m) {
  return {.force = check::direct_wall(wall.stiffness_N_m, damper_Ns_m, wall.velocity),
          .observer = wall.observer,
          .period_s = wall.period_s};
}

std::optional<Range> stable_dampers(const SampledWall& wall, const std::vector<LoopCase>& cases,
                                    const Scan& dampers) {
  return where([&](double damper) { return check::all_stable(loop_of(wall, damper), cases); },
               dampers);
}

double largest_uncertainty(const SampledLoop& loop, const LoopCase& nominal, double alpha,
                           double beta, double limit) {
  const auto stable = [&](double delta) {
    return check::all_stable(loop, check::scaled_devices(nominal, alpha, beta, {-delta, delta}));
  };
  if (!stable(0)) return 0;
  const double end = std::min({limit, alpha > 0 ? 1 / alpha : limit, beta > 0 ? 1 / beta : limit});
  constexpr int kSteps = 200;
  double inside = 0, outside = end;
  for (int i = 1; i < kSteps; ++i) {
    outside = end * i / kSteps;
    if (!stable(outside)) break;
    inside = outside;
    outside = end;
  }
  while (outside - inside > 1e-9 * end) {
    const double middle = 0.5 * (inside + outside);
    (stable(middle) ? inside : outside) = middle;
  }
  return inside;
}

double largest_stiffness(const SampledWall& wall, const std::vector<LoopCase>& cases,
                         const Scan& stiffnesses, const Scan& dampers) {
  const auto holds = [&](double stiffness) {
    SampledWall at = wall;
    at.stiffness_N_m = stiffness;
    const auto radius = [&](double damper) {
      const check::WorstCase worst = check::worst_of(loop_of(at, damper), cases);
      return std::isnan(worst.radius) ? std::numeric_limits<double>::infinity() : worst.radius;
    };
    return least(radius, dampers).value < 1;
  };
  const std::optional<Range> range = where(holds, stiffnesses);
  return range ? range->high : 0;
}

}  // namespace hapticd::synthesis
