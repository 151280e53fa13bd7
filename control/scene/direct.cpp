// Contacts that no coupling holds: every object pushes on the contact itself, none knows of the
// others, one visit of each is exact.
#include "control/scene/gains.h"
#include "control/scene/near.h"
#include "control/scene/solve.h"
#include "control/scene/visit.h"

namespace hapticd::control {
namespace {

/// The descent check: a proxy that came no nearer stays where it was.
void keep_if_no_nearer(const Plan& plan, const State& state, const Encounter& encounter,
                       EncounterState& at, const Vec3& x) noexcept {
  if (is_field(encounter.kind) || !at.now.touching || !at.next.touching) return;
  const Vec3 old = proxy_in_world(plan, state, encounter, at.now);
  const Vec3 found = proxy_in_world(plan, state, encounter, at.next);
  if (squared_norm(found - x) <= (1 + 1e-12) * squared_norm(old - x)) return;
  at.next = at.now;
  at.next.force = (1 / encounter.surface.compliance) * (old - x);
}

}  // namespace

void touch_directly(const Plan& plan, State& state, std::size_t index) noexcept {
  const ContactPlan& contact = plan.contacts[index];
  ContactState& own = state.contacts[index];
  const Vec3 x = point_of(contact, &state.x[contact.first_coordinate]);
  const bool starts = state.mode != Mode::enabled;
  update_near(plan, state, index, x);
  const Visitor visitor{.contact = contact,
                        .last = starts ? x : own.proxy,
                        .velocity = vector_of(contact, &state.v[contact.first_coordinate]),
                        .directly = true};
  Vec3 force;
  for (std::uint32_t i = 0; i < own.near_count; ++i) {
    const std::uint32_t encounter = state.near[contact.first_encounter + i];
    EncounterState& at = state.encounters[encounter];
    if (starts) at.now = {};
    visit(plan, state, encounter, visitor, x);
    keep_if_no_nearer(plan, state, plan.encounters[encounter], at, x);
    state.injected[contact.device] += injected(plan, state, encounter, at, visitor.last, x);
    at.now = at.next;
    force += at.now.force;
  }
  own.proxy = x;
  for (std::size_t i = 0; i < contact.coordinates; ++i)
    state.scene_force[contact.first_coordinate + i] += force[contact.direction[i]];
}

}  // namespace hapticd::control
