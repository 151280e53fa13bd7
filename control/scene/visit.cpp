#include "control/scene/visit.h"

#include <cmath>

#include "control/scene/ask.h"
#include "control/scene/object_place.h"

namespace hapticd::control {
namespace {

constexpr double kSettled = 1e-24;  ///< squared share of the first step that a last one may have
constexpr int kMaxFieldSteps = 8;   ///< Newton steps on a field

/// Force of a field at y, all in the world.
FieldValue field_at(const Plan& plan, const State& state, const Encounter& encounter,
                    const ObjectPlace& place, const Vec3& y, const Vec3& step) noexcept {
  FieldValue value =
      ask_field(plan, encounter, place.local(y), place.turned_to_local(step), state.scene_time_s);
  value.force = place.turned_to_world(value.force);
  return value;
}

/// (I + give H) d = r by Cramer's rule. The product of two matrices >= 0 has eigenvalues >= 0, so
/// the determinant is at least 1.
Vec3 newton_step(const Mat3& give, const Mat3& stiffness, const Vec3& r) noexcept {
  Mat3 m = give * stiffness;
  for (std::size_t i = 0; i < 3; ++i) m.row[i][i] += 1;
  return solve(m, r);
}

Vec3 visit_field(const Plan& plan, State& state, std::uint32_t index, const Visitor& visitor,
                 const Vec3& without) noexcept {
  const Encounter& encounter = plan.encounters[index];
  const ObjectPlace place(plan, state, encounter);
  const Vec3 last = place.carried(visitor.last);
  const Vec3 carried_on = last - visitor.last;
  Vec3 y = without;
  const auto at = [&] {
    const Vec3 step = visitor.directly ? plan.period_s * visitor.velocity - carried_on : y - last;
    return field_at(plan, state, encounter, place, y, step);
  };
  FieldValue value = at();
  double first = 0;
  for (int i = 0; i < kMaxFieldSteps && !visitor.directly; ++i) {
    const Mat3& give = visitor.contact.give;
    const Vec3 miss = without + give * value.force - y;
    const Vec3 step = newton_step(give, value.stiffness, miss);
    y += step;
    value = at();
    const double size = squared_norm(step);
    if (i == 0) first = size;
    if (!(size > kSettled * first)) break;
  }
  Touch& next = state.encounters[index].next;
  next = {.force = value.force, .touching = value.force != Vec3{}};
  return value.force;
}

/// Of a guide that lets go: leaving it costs that much stretch, so its energy is counted from
/// there. 0: of all else.
double squared_range(const Plan& plan, const Encounter& encounter) noexcept {
  double range = 0;
  if (encounter.kind == ObjectKind::point) range = plan.point_guides[encounter.shape].range;
  if (encounter.kind == ObjectKind::line) range = plan.line_guides[encounter.shape].range;
  if (encounter.kind == ObjectKind::curve) range = plan.curve_guides[encounter.shape].range;
  return std::isfinite(range) ? range * range : 0;
}

}  // namespace

Vec3 proxy_in_world(const Plan& plan, const State& state, const Encounter& encounter,
                    const Touch& touch) noexcept {
  return ObjectPlace(plan, state, encounter).world(touch.proxy);
}

Vec3 visit(const Plan& plan, State& state, std::uint32_t index, const Visitor& visitor,
           const Vec3& without) noexcept {
  if (is_field(plan.encounters[index].kind))
    return visit_field(plan, state, index, visitor, without);
  return visit_body(plan, state, index, visitor, without);
}

double energy(const Plan& plan, const State& state, std::uint32_t index, const Touch& touch,
              const Vec3& y, const Vec3& last) noexcept {
  const Encounter& encounter = plan.encounters[index];
  if (!is_field(encounter.kind)) {
    if (!touch.touching) return touch.pushed;
    const Vec3 stretch = proxy_in_world(plan, state, encounter, touch) - y;
    const double outside = squared_range(plan, encounter);
    return 0.5 * (squared_norm(stretch) - outside) / encounter.surface.compliance;
  }
  const ObjectPlace place(plan, state, encounter);
  const Vec3 step = y - place.carried(last);
  const FieldValue value = field_at(plan, state, encounter, place, y, step);
  return encounter.kind == ObjectKind::vibration ? -dot(value.force, step) : value.energy;
}

double injected(const Plan& plan, const State& state, std::uint32_t index, const EncounterState& at,
                const Vec3& last, const Vec3& y) noexcept {
  const Encounter& encounter = plan.encounters[index];
  if (encounter.kind == ObjectKind::vibration) return dot(at.next.force, y - last);
  if (encounter.path == kNoPath || is_field(encounter.kind)) return 0;
  if (!at.now.touching) return at.now.pushed;
  const ObjectPlace place(plan, state, encounter);
  const double before = squared_norm(place.world_before(at.now.proxy) - last);
  const double after = squared_norm(place.world(at.now.proxy) - last);
  return 0.5 * (after - before) / encounter.surface.compliance;
}

}  // namespace hapticd::control
