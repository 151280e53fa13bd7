#include "control/scene/solve.h"

#include "control/scene/descent.h"
#include "control/scene/limit.h"
#include "control/scene/visit.h"

namespace hapticd::control {

void solve_group(const Plan& plan, State& state, std::size_t index) noexcept {
  Together together(plan, state, index);
  bool found = together.group.max_sweeps > 0;
  if (found) {
    solve_within_limits(together);
    found = together.starts || descends(together);  // at the start no old proxy binds
  }
  if (!found) stay(together);
  together.finish();
}

double stored_energy(const Plan& plan, const State& state, const ContactPlan& contact) noexcept {
  const ContactState& own = state.contacts[contact.device];
  double sum = 0;
  for (std::uint32_t i = 0; i < own.near_count; ++i) {
    const std::uint32_t encounter = state.near[contact.first_encounter + i];
    const Touch& touch = state.encounters[encounter].now;
    sum += energy(plan, state, encounter, touch, own.proxy, own.proxy);
  }
  if (contact.group == ContactPlan::kNoGroup) return sum;
  const GroupPlan& group = plan.groups[contact.group];
  Rows stretch;
  for (std::size_t i = 0; i < group.contacts; ++i) {
    const ContactPlan& other = plan.contacts[plan.group_contacts[group.first_contact + i]];
    const ContactState& at = state.contacts[other.device];
    const Vec3 d = point_of(other, &state.x[other.first_coordinate]) - at.slack - at.proxy;
    put(other, d, &stretch[other.first_row]);
  }
  Rows force{};
  add_product(plan, group.stiffness, stretch.data(), force.data());
  for (std::size_t i = 0; i < contact.coordinates; ++i)
    sum += 0.5 * force[contact.first_row + i] * stretch[contact.first_row + i];
  return sum + force_limit(contact) * norm(own.slack);
}

}  // namespace hapticd::control
