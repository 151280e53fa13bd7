#include "control/design/check/objects.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

namespace hapticd::check {
namespace {

using control::ContactPlan;
using control::Encounter;
using control::ObjectKind;

bool is_convex(const control::Plan& plan, const Encounter& encounter) {
  const std::uint32_t i = encounter.shape;
  switch (encounter.kind) {
    case ObjectKind::plane:
      return true;
    case ObjectKind::box:
      return plan.boxes[i].free == control::Free::inside;
    case ObjectKind::sphere:
      return plan.spheres[i].free == control::Free::inside;
    case ObjectKind::cylinder:
      return plan.cylinders[i].free == control::Free::inside;
    case ObjectKind::capsule:
      return plan.capsules[i].free == control::Free::inside;
    case ObjectKind::point:
      return std::isinf(plan.point_guides[i].range);
    case ObjectKind::line:
      return std::isinf(plan.line_guides[i].range);
    case ObjectKind::constant:
      return std::isinf(plan.constant_fields[i].region.radius);
    default:
      return false;
  }
}

constexpr double kUnbounded = std::numeric_limits<double>::infinity();

double weakness_of(const control::Magnet& magnet) {
  constexpr double kLargest = 2 / (3 * std::numbers::sqrt3);  // of p (1 - p^2)
  const double k = control::steepest(magnet);
  if (magnet.radius == 0) return 2 * k;
  const double core = magnet.radius - magnet.range;
  return core > 0 ? k * std::max(2.0, kLargest * magnet.range / core) : kUnbounded;
}

double weakness_of(const control::Plan& plan, const Encounter& encounter) {
  if (encounter.path != control::kNoPath) return kUnbounded;
  const std::uint32_t i = encounter.shape;
  switch (encounter.kind) {
    case ObjectKind::constant:
      return is_convex(plan, encounter) ? 0 : control::steepest(plan.constant_fields[i]);
    case ObjectKind::detents:
      return control::steepest(plan.detents[i]);
    case ObjectKind::magnet:
      return weakness_of(plan.magnets[i]);
    case ObjectKind::viscous:
      return 0;
    default:
      return is_convex(plan, encounter) ? 0 : kUnbounded;
  }
}

ObjectShare asked_by(const control::Plan& plan, const Encounter& encounter) {
  const std::uint32_t i = encounter.shape;
  switch (encounter.kind) {
    case ObjectKind::viscous:
      return {0, plan.viscous_fields[i].damping};
    case ObjectKind::constant:
      return {control::steepest(plan.constant_fields[i]), 0};
    case ObjectKind::detents:
      return {control::steepest(plan.detents[i]), 0};
    case ObjectKind::magnet:
      return {control::steepest(plan.magnets[i]), 0};
    case ObjectKind::vibration:
      return {};
    default:
      return {1 / encounter.surface.compliance, encounter.surface.damping};
  }
}

/// Could both act within one tick? `reach` is twice the tool's radius and a tick's way.
bool overlap(const control::BoxNode& a, const control::BoxNode& b, double reach) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (static_cast<double>(a.min[i]) > static_cast<double>(b.max[i]) + reach ||
        static_cast<double>(b.min[i]) > static_cast<double>(a.max[i]) + reach)
      return false;
  }
  return true;
}

double reach_of(const control::Plan& plan, const ContactPlan& contact) {
  double step = 0;
  const control::DevicePlan& device = plan.devices[contact.device];
  for (std::size_t i = 0; i < device.axes; ++i) step += plan.axes[device.first_axis + i].max_step;
  return 2 * (contact.radius + step);
}

/// The most that objects with bounds can add at one place: for each, all that overlap it.
ObjectShare most_bounded(const control::Plan& plan, const ContactPlan& contact) {
  ObjectShare most;
  const control::BoxTree& tree = contact.objects;
  const double reach = reach_of(plan, contact);
  for (const control::BoxNode& leaf : tree.nodes) {
    if (leaf.count == 0) continue;
    ObjectShare sum;
    std::vector<std::uint32_t> stack{0};
    while (!stack.empty()) {
      const std::uint32_t index = stack.back();
      stack.pop_back();
      const control::BoxNode& node = tree.nodes[index];
      if (!overlap(node, leaf, reach)) continue;
      for (std::uint32_t i = 0; i < node.count; ++i)
        sum += asked_by(plan, plan.encounters[tree.items[node.first + i]]);
      if (node.count == 0) stack.insert(stack.end(), {node.first, node.first + 1u});
    }
    most.stiffness = std::max(most.stiffness, sum.stiffness);
    most.damping = std::max(most.damping, sum.damping);
  }
  return most;
}

}  // namespace

ObjectShare objects_of(const control::Plan& plan, const ContactPlan& contact, bool& convex) {
  const std::uint32_t end = contact.first_encounter + contact.encounters;
  const bool sorted = !contact.objects.nodes.empty();
  ObjectShare sum = sorted ? most_bounded(plan, contact) : ObjectShare{};
  const std::uint32_t first = sorted ? contact.first_boundless : contact.first_encounter;
  for (std::uint32_t e = first; e < end; ++e) sum += asked_by(plan, plan.encounters[e]);
  for (std::uint32_t e = contact.first_encounter; e < end; ++e) {
    convex = convex && is_convex(plan, plan.encounters[e]) &&
             plan.encounters[e].surface.static_friction == 0;
    sum.weakness += weakness_of(plan, plan.encounters[e]);
  }
  return sum;
}

Behind behind(const control::Plan& plan, const Tied& devices) {
  Behind scene;
  scene.weakness.assign(plan.coordinates, 0);
  // Without a sweep proxies stay where they are: another loop than the linear one.
  scene.linear =
      std::none_of(plan.groups.begin(), plan.groups.end(),
                   [](const control::GroupPlan& group) { return group.max_sweeps == 0; });
  for (const ContactPlan& contact : plan.contacts) {
    if (std::find(devices.begin(), devices.end(), contact.device) == devices.end()) continue;
    const std::uint32_t end = contact.first_encounter + contact.encounters;
    for (std::uint32_t e = contact.first_encounter; e < end; ++e) {
      const Encounter& encounter = plan.encounters[e];
      scene.any = true;
      scene.linear =
          scene.linear && encounter.kind == ObjectKind::constant && is_convex(plan, encounter);
    }
    bool ignored = true;
    const double weakness = objects_of(plan, contact, ignored).weakness;
    for (std::size_t i = 0; i < contact.coordinates; ++i)
      scene.weakness[std::size_t{contact.first_coordinate} + i] = weakness;
    scene.weakest = std::max(scene.weakest, weakness);
  }
  return scene;
}

}  // namespace hapticd::check
