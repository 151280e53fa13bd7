#include "daemon/hapticctl_robust.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "control/design/check/models.h"
#include "control/design/check/robust.h"
#include "control/design/synthesis/common_search.h"
#include "control/design/synthesis/sampled_search.h"
#include "control/design/synthesis/transmitted.h"
#include "daemon/hapticctl_groups.h"

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
std::string beside(const control::Plan& plan, std::size_t d) {
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
    if (observer.source == device.first_axis && observer.command_share != 0)
      return "an observer that feeds commands back is lost with some hands, and no range of hands "
             "is known";
  }
  return {};
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
  one.stiffness = scale * scale * plane.stiffness;
  one.damper = scale * scale * plane.damping;
  one.loop.force = check::direct_wall(one.stiffness, one.damper, velocity);
  return true;
}

/// Coupling and networks alone.
void take_scene(const config::Compiled& compiled, std::size_t d, AxisLoop& one) {
  for (const Group& group : groups_of(compiled)) {
    if (group.devices != check::Tied{d}) continue;
    if (!group.linear) break;
    one.loop.force = check::rendered_scene(group.model.F);
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
  if (one.why.empty()) one.why = beside(plan, d);
  if (!one.why.empty()) return one;
  take_box(compiled.document.config.devices[d], compiled.assumed[d].latency_s, one);
  one.loop.period_s = plan.period_s;
  for (const control::ObserverPlan& observer : plan.axis_observers)
    if (observer.source == device.first_axis) one.loop.observer = observer;
  if (plan.devices.size() == 1 && plan.contacts.empty() && take_wall(plan, device, one)) return one;
  take_scene(compiled, d, one);
  return one;
}

/// A P for what may change from tick to tick, else for devices that stay as they are. Open, the device
/// is alone and drifts wherever it is: that is no contraction, so the proof is about a contact that
/// stays closed.
check::RobustAnswer answer_of(const AxisLoop& one) {
  const check::RobustAnswer sampled = check::robust(one.loop, one.box);
  check::LoopBox closed = one.box;
  closed.contact = {1, 1};
  if (sampled.kind != check::Robust::sampled || !check::excluded(one.loop, closed).empty())
    return sampled;
  auto found = synthesis::find_common(one.loop, closed);
  if (found.P.empty()) found = synthesis::find_constant(one.loop, closed);
  if (found.P.empty()) return sampled;
  check::RobustAnswer proved = check::robust(one.loop, closed, found.P);
  proved.cases = sampled.cases;
  proved.worst = sampled.worst;
  return proved;
}

/// Share by which mass and damping may be off together, by one factor, at any of some latencies.
double tolerated(const AxisLoop& one) {
  constexpr int kLatencies = 4;
  const int latencies = one.box.latency_s.high > 0 ? kLatencies : 0;
  double least = 1;
  for (int i = 0; i <= latencies; ++i) {
    const double latency_s = latencies == 0 ? 0 : one.box.latency_s.high * i / latencies;
    const check::LoopCase nominal{
        .mass_kg = one.mass, .damping_Ns_m = one.damping, .latency_s = latency_s};
    least = std::min(least, synthesis::largest_uncertainty(one.loop, nominal, 1, 1, 1));
  }
  return least;
}

Json paper_of_wall(const AxisLoop& one) {
  const synthesis::WallGoal goal{.mass_kg = one.mass,
                                 .damping_Ns_m = one.damping,
                                 .mass_uncertainty = one.mass_share,
                                 .damping_uncertainty = one.damping_share,
                                 .stiffness_N_m = one.stiffness,
                                 .wall_damping_Ns_m = one.damper,
                                 .period_s = one.loop.period_s,
                                 .hold = {}};
  if (!synthesis::malformed(goal).empty()) return nullptr;
  const double norm = synthesis::perturbation_norm(goal, one.damper);
  const bool stable = synthesis::nominally_stable(goal, one.damper);
  return {{"answer", stable && norm <= 1 ? "yes" : "no"},
          {"nominally_stable", stable},
          {"norm_dB", norm > 0 ? Json(20 * std::log10(norm)) : Json(nullptr)},
          {"hold", "adams_hannaford"}};
}

const char* name_of(check::Robust kind) {
  switch (kind) {
    case check::Robust::proved:
      return "proved while the contact stays closed";
    case check::Robust::proved_constant:
      return "proved while the contact stays closed, for devices that do not change";
    case check::Robust::sampled:
      return "sampled";
    case check::Robust::no:
      break;
  }
  return "no";
}

Json entry_of(const AxisLoop& one) {
  if (!one.why.empty())
    return {{"device", one.device}, {"answer", "not available"}, {"why", one.why}};
  const check::RobustAnswer answer = answer_of(one);
  Json entry{{"device", one.device},
             {"answer", name_of(answer.kind)},
             {"why", answer.why},
             {"cases", answer.cases},
             {"largest_eigenvalue", answer.worst.radius},
             {"worst", check::described(answer.worst.at)},
             {"hand", "none"},
             {"tolerated_share", tolerated(one)}};
  if (one.wall) entry["paper"] = paper_of_wall(one);
  return entry;
}

}  // namespace

std::vector<AxisLoop> axis_loops(const config::Compiled& compiled) {
  std::vector<AxisLoop> loops;
  for (std::size_t d = 0; d < compiled.program->plan().devices.size(); ++d)
    loops.push_back(axis_loop(compiled, d));
  return loops;
}

Json robust_json(const config::Compiled& compiled) {
  Json all = Json::array();
  for (const AxisLoop& one : axis_loops(compiled)) all.push_back(entry_of(one));
  return all;
}

std::string robust_text(const Json& robust) {
  std::string text =
      "robust (the sampled loop, exactly: devices of the model's box, latency up to latency_s, no "
      "hand; proofs are about a contact that stays closed):\n";
  for (const Json& one : robust) {
    text += fmt::format("  {}: {}: {}\n", one["device"].get<std::string>(),
                        one["answer"].get<std::string>(), one["why"].get<std::string>());
    if (one.contains("tolerated_share"))
      text += fmt::format(
          "    as given it stays stable while mass and damping are off, by one factor, by less "
          "than {:.1f} %\n",
          100 * one["tolerated_share"].get<double>());
    if (one.contains("paper") && one["paper"].is_object()) {
      const Json& paper = one["paper"];
      text +=
          fmt::format("    paper (Eom, Suh and Yi's norm, which the sampled loop overrules): {}",
                      paper["answer"].get<std::string>());
      if (paper["norm_dB"].is_number())
        text += fmt::format(", |L| = {:.4g} dB", paper["norm_dB"].get<double>());
      text += paper["nominally_stable"].get<bool>() ? "\n" : ", nominally unstable\n";
    }
  }
  return text;
}

}  // namespace hapticd::daemon
