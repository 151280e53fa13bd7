#include "daemon/hapticctl_zwidth_lines.h"

#include <algorithm>
#include <utility>

#include "control/design/synthesis/sampled_search.h"
#include "daemon/hapticctl_robust.h"
#include "daemon/stability_gate.h"
#include "daemon/wall_of.h"

namespace hapticd::daemon {
namespace {

constexpr double kLeast_N_m = 1;

/// By the loop's eigenvalues; no simulation, so nothing fails on the way.
double stiffest_of(const AxisLoop& one, double damping, const std::vector<check::LoopCase>& cases) {
  const auto stable = [&](double stiffness) -> Result<bool> {
    check::SampledLoop loop = one.loop;
    loop.force = check::direct_wall(one.scale * stiffness, one.scale * damping, one.velocity);
    return check::worst_of(loop, cases).radius < check::kStableBelow;
  };
  return stiffest(kLeast_N_m, stable).value_or(0);
}

double stiffest_of_paper(AxisLoop one, const config::PaperModel& model, double damping) {
  const auto robust = [&](double stiffness) -> Result<bool> {
    one.stiffness = one.scale * stiffness;
    const synthesis::WallGoal goal = paper_goal(one, model);
    const double damper = one.scale * damping;
    return synthesis::nominally_stable(goal, damper) &&
           synthesis::perturbation_norm(goal, damper) <= 1;
  };
  return stiffest(kLeast_N_m, robust).value_or(0);
}

}  // namespace

Result<config::Compiled> with_wall(config::Document document, double stiffness_N_m,
                                   double damping_Ns_m) {
  config::Plane& plane = wall_of(document.config);
  plane.stiffness_N_m = stiffness_N_m;
  plane.damping_Ns_m = damping_Ns_m;
  auto compiled = config::compile(std::move(document));
  if (!compiled) return fail(ExitCode::bad_data, config::to_string(compiled.error().front()));
  return std::move(*compiled);
}

Result<StiffestWalls> stiffest_walls(const config::Document& document, double damping_Ns_m) {
  auto compiled = with_wall(document, kLeast_N_m, damping_Ns_m);
  if (!compiled) return tl::unexpected(compiled.error());
  const AxisLoop one = axis_loops(*compiled).front();
  check::LoopBox closed = one.box;
  closed.contact = {1, 1};
  const check::LoopCase given{
      .mass_kg = one.mass, .damping_Ns_m = one.damping, .latency_s = one.box.latency_s.high};
  StiffestWalls walls;
  walls.exact = stiffest_of(one, damping_Ns_m, {given});
  walls.robust = stiffest_of(one, damping_Ns_m, check::cases_of(closed, 3));
  walls.paper = stiffest_of_paper(one, document.config.stability.paper, damping_Ns_m);
  const auto proved = [&](double stiffness) -> Result<bool> {
    auto at = with_wall(document, stiffness, damping_Ns_m);
    if (!at) return tl::unexpected(at.error());
    return stability_gate(*at).proved();
  };
  auto passive = stiffest(kLeast_N_m, proved);
  if (!passive) return tl::unexpected(passive.error());
  walls.passive = *passive;
  walls.colgate =
      std::max(0.0, 2 * (one.box.damping_Ns_m.low / one.scale - damping_Ns_m) / one.loop.period_s);
  return walls;
}

}  // namespace hapticd::daemon
