#include "control/scene/near.h"

namespace hapticd::control {
namespace {

/// What was touched in the last tick stays on the list: a proxy may hold on to a thin wall whose
/// far side the contact has left behind.
void keep_touched(State& state, std::uint32_t* list, std::uint32_t& kept, std::uint32_t count) {
  for (std::uint32_t i = 0; i < count; ++i) {
    if (state.encounters[list[i]].now.touching) list[kept++] = list[i];
  }
}

void make_list(const Plan& plan, State& state, std::size_t index, const Vec3& point) noexcept {
  const ContactPlan& contact = plan.contacts[index];
  ContactState& own = state.contacts[index];
  std::uint32_t* list = &state.near[contact.first_encounter];
  std::uint32_t count = 0;
  keep_touched(state, list, count, own.near_made ? own.near_count : 0);
  const std::uint32_t end = contact.first_encounter + contact.encounters;
  const auto add = [&](std::uint32_t encounter) {
    if (!state.encounters[encounter].now.touching) list[count++] = encounter;
  };
  visit_near(contact.objects, point, contact.margin + contact.radius, add);
  for (std::uint32_t e = contact.first_boundless; e < end; ++e) add(e);
  own.near_centre = point;
  own.near_count = count;
  own.near_made = true;
}

}  // namespace

void update_near(const Plan& plan, State& state, std::size_t index, const Vec3& point) noexcept {
  const ContactPlan& contact = plan.contacts[index];
  if (!(contact.margin > 0)) return;
  const ContactState& own = state.contacts[index];
  const bool holds =
      own.near_made && squared_norm(point - own.near_centre) <= contact.margin * contact.margin;
  if (!holds) make_list(plan, state, index, point);
}

}  // namespace hapticd::control
