#include "daemon/cost.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <variant>

#include "control/scene/near.h"
#include "daemon/cost_object.h"
#include "daemon/cost_parts.h"
#include "daemon/cost_predict.h"
#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

Walk device_walk(const Pose& pose) {
  Walk walk;
  for (std::size_t i = 0; i < kWalkTicks; ++i) {
    for (std::size_t axis = 0; axis < pose.raw.size(); ++axis)
      walk[i].push_back(pose.raw[axis] + 5 * pose.step[axis] * walked(i));
  }
  return walk;
}

Figure between(const build::ProgramSpec& with, const build::ProgramSpec& without, const Walk& walk,
               std::size_t ticks, double floor_ns) {
  CostRig more(with), less(without);
  more.walk(walk);
  less.walk(walk);
  return difference(more, less, ticks, floor_ns);
}

Cost loop_cost(const build::ProgramSpec& spec, std::size_t ticks) {
  CostRig rig(spec);
  rig.walk(device_walk(working_pose(spec)));
  Cost cost{.predicted_ns = predicted_loop_ns(spec), .measured = tick_time(rig, ticks)};
  if (rig.fault().code != Fault::none)
    cost.note = "measured in fault " + std::string(entry(rig.fault().code).name);
  return cost;
}

Cost observers_cost(const build::ProgramSpec& loop, const build::ProgramSpec& observed,
                    const CostReport& report) {
  const double predicted = predicted_observers_ns(observed);
  if (predicted == 0) return {.measured = Figure{}, .note = "none"};
  return {.predicted_ns = predicted,
          .measured = between(observed, loop, device_walk(working_pose(loop)), report.ticks,
                              report.floor_ns)};
}

Cost coupling_cost(const build::ProgramSpec& scene, const CostReport& report) {
  const build::ProgramSpec coupled = without_objects(with_ideal_devices(scene));
  if (coupled.contacts.empty()) return {.measured = Figure{}, .note = "none"};
  const CostRig rig(coupled);
  return {.predicted_ns = predicted_coupling_ns(rig.program().plan()),
          .measured = between(coupled, without_scene(coupled), device_walk(working_pose(coupled)),
                              report.ticks, report.floor_ns),
          .note = rig.program().plan().groups.empty() ? "contacts, rendered directly" : ""};
}

/// Lists made anew along a way through the middle of the objects, 0.1 mm per tick.
Figure lists_time(build::Program& program, std::size_t contact, std::size_t ticks) {
  const control::BoxNode& all = program.plan().contacts[contact].objects.nodes.front();
  Vec3 point;
  for (std::size_t i = 0; i < 3; ++i)
    point[i] = 0.5 * (static_cast<double>(all.min[i]) + static_cast<double>(all.max[i]));
  const std::size_t batch = std::max<std::size_t>(1, ticks / kBatches);
  std::vector<double> times(kBatches);
  double sign = 1;
  for (double& time : times) {
    const std::int64_t began = monotonic_ns();
    for (std::size_t i = 0; i < batch; ++i) {
      point.x += sign * 1e-4;
      control::update_near(program.plan(), program.state(), contact, point);
    }
    time = static_cast<double>(monotonic_ns() - began) / static_cast<double>(batch);
    sign = -sign;
  }
  return median_figure(times, 0);
}

Cost broad_phase_cost(build::Program& scene, std::size_t ticks) {
  const double predicted = predicted_broad_phase_ns(scene.plan());
  if (predicted == 0) return {.measured = Figure{}, .note = "none: few objects, all looked at"};
  Figure sum;
  for (std::size_t c = 0; c < scene.plan().contacts.size(); ++c) {
    if (scene.plan().contacts[c].margin > 0) sum.ns += lists_time(scene, c, ticks).ns;
  }
  return {.predicted_ns = predicted, .measured = sum, .note = "at 0.1 mm per tick"};
}

void add(Cost& sum, const Cost& part, double count) {
  sum.predicted_ns += count * part.predicted_ns;
  if (!part.measured) return;
  if (!sum.measured) sum.measured = Figure{};
  sum.measured->ns += count * part.measured->ns;
  sum.measured->resolution_ns =
      std::hypot(sum.measured->resolution_ns, count * part.measured->resolution_ns);
}

/// Those of a kind that have no figures of their own: the mean of those that have.
ObjectCost summary(const std::string& kind, const std::vector<ObjectCost>& objects,
                   std::size_t count) {
  ObjectCost all{.kind = kind, .count = count};
  double alike = 0;
  for (const ObjectCost& object : objects) alike += object.kind == kind ? 1 : 0;
  for (const ObjectCost& object : objects) {
    if (object.kind != kind) continue;
    add(all.distant, object.distant, 1 / alike);
    add(all.touched, object.touched, 1 / alike);
    all.distant.note = object.distant.note;
  }
  all.touched.note = "each, by the mean of those above";
  return all;
}

void measure_objects(const config::Compiled& compiled, CostReport& report) {
  ObjectCosting costing(compiled, report.ticks, report.floor_ns);
  std::map<std::string, std::size_t> of_kind;
  for (const config::SceneObject& object : compiled.document.config.scene) {
    if (std::holds_alternative<config::Network>(object)) continue;  // folded into the coupling
    if (++of_kind[kind_name(object)] <= kObjectsOfAKind)
      report.objects.push_back(costing.measure(object));
  }
  for (const auto& [kind, count] : of_kind) {
    if (count > kObjectsOfAKind)
      report.objects.push_back(summary(kind, report.objects, count - kObjectsOfAKind));
  }
}

double touch_ns(const ObjectCost& object) {
  const auto ns = [](const Cost& cost) { return cost.measured ? cost.measured->ns : 0; };
  return object.touched.measured ? ns(object.touched) - ns(object.distant) : -1;
}

void add_totals(CostReport& report) {
  for (const StageCost& stage : report.stages) add(report.untouched, stage.cost, 1);
  for (const ObjectCost& object : report.objects)
    add(report.untouched, object.distant, static_cast<double>(object.count));
  report.busiest = report.untouched;
  const auto most = std::max_element(
      report.objects.begin(), report.objects.end(),
      [](const ObjectCost& a, const ObjectCost& b) { return touch_ns(a) < touch_ns(b); });
  if (most == report.objects.end() || touch_ns(*most) < 0) return;
  add(report.busiest, most->touched, 1);
  add(report.busiest, most->distant, -1);
  report.busiest_name = most->kind + " " + most->name;
}

}  // namespace

CostReport cost(const config::Compiled& compiled, const CostOptions& options) {
  const build::ProgramSpec& scene = compiled.program->spec();
  const build::ProgramSpec observed = without_homing(without_scene(scene));
  const build::ProgramSpec loop = without_observers(observed);
  CostReport report{.period_ns = scene.period_s * 1e9, .ticks = options.ticks};
  report.floor_ns = resolution_floor_ns(loop, device_walk(working_pose(loop)), options.ticks);
  build::Program whole(scene);  // the caller's own stays as it is
  report.stages = {{"loop", loop_cost(loop, options.ticks)},
                   {"observers", observers_cost(loop, observed, report)},
                   {"coupling and networks", coupling_cost(scene, report)},
                   {"broad phase", broad_phase_cost(whole, options.ticks)}};
  measure_objects(compiled, report);
  add_totals(report);
  return report;
}

}  // namespace hapticd::daemon
