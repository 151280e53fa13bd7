#include "control/guard/bound.h"

#include <algorithm>
#include <cmath>

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {
namespace {

/// How far `value` is beyond the range; negative below it, 0 inside.
double beyond(double value, double min, double max) noexcept {
  return value < min ? value - min : std::max(0.0, value - max);
}

void bound_travel(const TravelPlan& travel, State& state, Findings& findings) noexcept {
  const double out = beyond(state.q[travel.axis], travel.min, travel.max);
  state.travel[travel.axis] =
      std::clamp(-travel.stiffness * out, -travel.max_effort, travel.max_effort);
  if (out == 0) return;
  findings.limits.set(Limit::travel);
  if (std::abs(out) <= travel.margin) return;
  findings.report({.code = Fault::travel,
                   .axis = travel.axis,
                   .found = state.q[travel.axis],
                   .allowed = (out < 0 ? travel.min : travel.max) +
                              (out < 0 ? -travel.margin : travel.margin)});
}

void bound_workspace(const WorkspacePlan& box, const DevicePlan& device, const State& state,
                     Findings& findings) noexcept {
  for (std::size_t i = 0; i < device.coordinates; ++i) {
    const double x = state.x[device.first_coordinate + i];
    if (x >= box.min[i] && x <= box.max[i]) continue;
    findings.report({.code = Fault::workspace,
                     .device = box.device,
                     .found = x,
                     .allowed = x < box.min[i] ? box.min[i] : box.max[i]});
  }
}

}  // namespace

void bound(const Plan& plan, State& state, Findings& findings) noexcept {
  if (!findings.homed || !findings.ready) return;
  for (const TravelPlan& travel : plan.travels) bound_travel(travel, state, findings);
  for (const WorkspacePlan& box : plan.workspaces)
    bound_workspace(box, plan.devices[box.device], state, findings);
}

}  // namespace hapticd::control
