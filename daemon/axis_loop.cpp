#include "daemon/axis_loop.h"

#include <algorithm>
#include <utility>

#include "config/matrices.h"
#include "control/design/check/models.h"
#include "daemon/groups.h"

namespace hapticd::daemon {
namespace {

using check::System;

/// The estimator of an axis, as the simple planes use it; nothing: it has no linear model.
std::optional<System> velocity_of(const control::Plan& plan, std::uint16_t axis) {
  for (const auto& one : plan.foaws)
    if (one.axis == axis) return {};
  for (const auto& one : plan.low_passes)
    if (one.axis == axis) return check::velocity_of(one, plan.period_s);
  for (const auto& one : plan.least_squares)
    if (one.axis == axis) return check::velocity_of(one);
  for (const auto& one : plan.alpha_beta_gammas)
    if (one.axis == axis) return check::velocity_of(one, plan.period_s);
  return check::backward_difference(plan.period_s);
}

std::string device_problem(const config::Compiled& compiled, std::size_t d) {
  const control::DevicePlan& device = compiled.program->plan().devices[d];
  const config::Device& written = compiled.document.config.devices[d];
  if (device.axes != 1 || device.coordinates != 1 ||
      !std::holds_alternative<config::Cartesian>(written.kinematics))
    return "the exact loop is known for devices of one axis";
  const auto& model = written.axes[0].model;
  if (!model || !(model->mass_kg || model->inertia_kgm2) ||
      !(model->damping_Ns_m || model->damping_Nms_rad))
    return "the axis has no `model` with mass and damping";
  return {};
}

/// What acts on the axis beside wall, coupling and observer, and is not in the loop that is looked at.
std::string beside(const control::Plan& plan, std::size_t d, bool hand_known) {
  const control::DevicePlan& device = plan.devices[d];
  const auto own = [&](const auto& all, auto&& axis_of) {
    return std::ranges::any_of(all, [&](const auto& one) {
      return axis_of(one) >= device.first_axis && axis_of(one) < device.first_axis + device.axes;
    });
  };
  const auto axis = [](const auto& one) { return int{one.axis}; };
  if (own(plan.frictions, axis)) return "a compensation of friction acts on the axis";
  if (own(plan.gravity_axes, axis)) return "a compensation of weight acts on the axis";
  if (own(plan.travels, axis)) return "springs at the ends of its travel act on the axis";
  for (const control::ObserverPlan& observer : plan.contact_observers)
    if (observer.device == d) return "an observer acts at its contact";
  for (const control::ObserverPlan& observer : plan.axis_observers) {
    if (observer.source == device.first_axis && observer.command_share != 0 && !hand_known)
      return "an observer that feeds commands back is lost with some hands; say which there are: "
             "stability.hand";
  }
  return {};
}

check::Side side_of(const config::Range& range) {
  return {range[0], range[1]};
}

void take_hand(const config::HandRange& hand, check::LoopBox& box) {
  box.hand_kg = side_of(hand.mass_kg);
  box.hand_Ns_m = side_of(hand.damping_Ns_m);
  box.hand_N_m = side_of(hand.stiffness_N_m);
}

void take_box(const config::Device& written, double latency_s, AxisLoop& one) {
  const config::AxisModel& model = *written.axes[0].model;
  one.mass = model.mass_kg ? *model.mass_kg : *model.inertia_kgm2;
  one.damping = model.damping_Ns_m ? *model.damping_Ns_m : *model.damping_Nms_rad;
  one.mass_share = model.mass_uncertainty;
  one.damping_share = model.damping_uncertainty;
  one.box.mass_kg = {one.mass * (1 - one.mass_share), one.mass * (1 + one.mass_share)};
  one.box.damping_Ns_m = {one.damping * (1 - one.damping_share),
                          one.damping * (1 + one.damping_share)};
  one.box.latency_s = {0, latency_s};
  one.box.contact = {0, 1};
}

/// One plane and nothing else: its force is K x + B_c v.
bool take_wall(const control::Plan& plan, const control::DevicePlan& device, AxisLoop& one) {
  if (plan.planes.size() != 1) return false;
  const control::PlaneContact& plane = plan.planes[0];
  if (plane.first_coordinate != device.first_coordinate) return false;
  const auto velocity = velocity_of(plan, device.first_axis);
  if (!velocity) {
    one.why = "the velocity estimator foaw has no linear model";
    return true;
  }
  const double scale = check::constant_jacobian(plan, {0})(0, 0) * plane.normal[0];
  one.wall = true;
  one.velocity = velocity;
  one.scale = scale * scale;
  one.stiffness = one.scale * plane.stiffness;
  one.damper = one.scale * plane.damping;
  one.loop.force = check::direct_wall(one.stiffness, one.damper, velocity);
  return true;
}

/// Coupling and networks alone.
void take_scene(const config::Compiled& compiled, std::size_t d, AxisLoop& one) {
  for (const Group& group : groups_of(compiled)) {
    if (group.devices != check::Tied{d}) continue;
    if (!group.linear) break;
    const double scale = check::constant_jacobian(compiled.program->plan(), {d})(0, 0);
    one.scale = scale * scale;
    one.loop.force = check::rendered_scene(check::scaled(group.model.F, one.scale));
    one.box.contact = {1, 1};  // nothing here lets go
    return;
  }
  one.why =
      "the exact loop is known for one plane that is rendered directly, or for a coupling with "
      "networks and nothing else";
}

AxisLoop axis_loop(const config::Compiled& compiled, std::size_t d) {
  const control::Plan& plan = compiled.program->plan();
  const control::DevicePlan& device = plan.devices[d];
  AxisLoop one{.device = compiled.document.config.devices[d].name,
               .why = device_problem(compiled, d)};
  const std::optional<config::HandRange>& hand = compiled.document.config.stability.hand;
  if (one.why.empty()) one.why = beside(plan, d, hand.has_value());
  if (!one.why.empty()) return one;
  take_box(compiled.document.config.devices[d], compiled.assumed[d].latency_s, one);
  if (hand) take_hand(*hand, one.box);
  one.loop.period_s = plan.period_s;
  for (const control::ObserverPlan& observer : plan.axis_observers)
    if (observer.source == device.first_axis) one.loop.observer = observer;
  if (!(plan.devices.size() == 1 && plan.contacts.empty() && take_wall(plan, device, one)))
    take_scene(compiled, d, one);
  if (one.why.empty()) one.why = check::malformed(one.loop, one.box);
  return one;
}

}  // namespace

std::vector<AxisLoop> axis_loops(const config::Compiled& compiled) {
  std::vector<AxisLoop> loops;
  for (std::size_t d = 0; d < compiled.program->plan().devices.size(); ++d)
    loops.push_back(axis_loop(compiled, d));
  return loops;
}

Result<AxisLoop> only_loop(const config::Compiled& compiled) {
  std::vector<AxisLoop> loops = axis_loops(compiled);
  if (loops.size() != 1)
    return fail(ExitCode::bad_data, "expected one device, found " + std::to_string(loops.size()));
  if (!loops[0].why.empty()) return fail(ExitCode::bad_data, loops[0].why);
  return std::move(loops[0]);
}

Result<AxisLoop> only_wall(const config::Compiled& compiled) {
  auto one = only_loop(compiled);
  if (one && !one->wall)
    return fail(ExitCode::bad_data,
                "expected one plane that is rendered directly; this scene has another");
  return one;
}

std::vector<check::Matrix> proof_of(const config::Compiled& compiled, const std::string& device) {
  std::vector<check::Matrix> P;
  for (const config::DeviceProof& one : compiled.document.proofs) {
    if (one.device != device) continue;
    for (const config::Rows& rows : one.P) P.push_back(config::as_matrix(rows));
  }
  return P;
}

std::string robust_words(const check::RobustAnswer& answer) {
  switch (answer.kind) {
    case check::Robust::proved:
      return "proved, whatever changes from tick to tick";
    case check::Robust::proved_constant:
      return "proved for devices and hands that do not change";
    case check::Robust::sampled:
      return "sampled";
    case check::Robust::no:
      break;
  }
  return "no";
}

}  // namespace hapticd::daemon
