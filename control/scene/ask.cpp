#include "control/scene/ask.h"

namespace hapticd::control {

Nearest nearest_free(const Plan& plan, State& state, const Encounter& encounter, bool touching,
                     const Vec3& point, const Vec3& from, double radius) noexcept {
  const std::uint32_t i = encounter.shape;
  switch (encounter.kind) {
    case ObjectKind::plane:
      return nearest(plan.free_planes[i], point, from, radius);
    case ObjectKind::relief:
      return nearest(plan.reliefs[i], point, from, radius);
    case ObjectKind::box:
      return nearest(plan.boxes[i], point, from, radius);
    case ObjectKind::sphere:
      return nearest(plan.spheres[i], point, from, radius);
    case ObjectKind::cylinder:
      return nearest(plan.cylinders[i], point, from, radius);
    case ObjectKind::capsule:
      return nearest(plan.capsules[i], point, from, radius);
    case ObjectKind::mesh: {
      MeshWalk& walk = state.walks[encounter.walk];
      walk.touching = touching;
      return nearest(plan.meshes[i], walk, point, from, radius);
    }
    case ObjectKind::point:
      return nearest(plan.point_guides[i], point);
    case ObjectKind::line:
      return nearest(plan.line_guides[i], point);
    case ObjectKind::curve:
      return nearest(plan.curve_guides[i], plan.curve_points, point,
                     state.segments[encounter.walk]);
    default:
      return {};
  }
}

FieldValue ask_field(const Plan& plan, const Encounter& encounter, const Vec3& y, const Vec3& step,
                     double time_s) noexcept {
  const std::uint32_t i = encounter.shape;
  switch (encounter.kind) {
    case ObjectKind::viscous:
      return evaluate(plan.viscous_fields[i], y, step, plan.period_s);
    case ObjectKind::constant:
      return evaluate(plan.constant_fields[i], y);
    case ObjectKind::detents:
      return evaluate(plan.detents[i], y);
    case ObjectKind::magnet:
      return evaluate(plan.magnets[i], y);
    case ObjectKind::vibration:
      return evaluate(plan.vibrations[i], y, time_s);
    default:
      return {};
  }
}

}  // namespace hapticd::control
