#include "control/scene/carry.h"

#include <algorithm>

#include "control/scene/gains.h"

namespace hapticd::control {
namespace {

bool same_form(const GroupPlan& a, const GroupPlan& b) noexcept {
  return a.coordinates == b.coordinates && a.memory == b.memory && a.states == b.states &&
         a.first_memory == b.first_memory && a.first_state == b.first_state &&
         a.remembers_stretch == b.remembers_stretch;
}

bool same_groups(const Plan& a, const Plan& b) noexcept {
  return std::equal(a.groups.begin(), a.groups.end(), b.groups.begin(), b.groups.end(),
                    same_form) &&
         std::equal(a.group_contacts.begin(), a.group_contacts.end(), b.group_contacts.begin(),
                    b.group_contacts.end());
}

/// Each network at rest with its contacts where they are.
void begin(const Plan& plan, const GroupPlan& group, State& state) noexcept {
  Rows x;
  for (std::size_t i = 0; i < group.contacts; ++i) {
    const ContactPlan& contact = plan.contacts[plan.group_contacts[group.first_contact + i]];
    std::copy_n(&state.x[contact.first_coordinate], contact.coordinates, &x[contact.first_row]);
  }
  double* network = state.network.data() + group.first_state;
  add_product(plan, group.begin, x.data(), network);
  for (std::size_t i = 0; i < group.begin_rest.rows; ++i)
    network[i] += plan.gains[group.begin_rest.offset + i];
}

}  // namespace

void carry_scene(const Plan& from_plan, const State& from, const Plan& to_plan,
                 State& to) noexcept {
  to.scene_time_s = from.scene_time_s;
  std::copy_n(from.injected.begin(), std::min(from.injected.size(), to.injected.size()),
              to.injected.begin());
  for (std::size_t i = 0; i < to.contacts.size(); ++i) {
    const ContactPlan& contact = to_plan.contacts[i];
    to.contacts[i].proxy = i < from.contacts.size()
                               ? from.contacts[i].proxy
                               : point_of(contact, &to.x[contact.first_coordinate]);
  }
  if (same_groups(from_plan, to_plan)) {
    std::copy(from.coupling_memory.begin(), from.coupling_memory.end(), to.coupling_memory.begin());
    std::copy(from.network.begin(), from.network.end(), to.network.begin());
    return;
  }
  for (const GroupPlan& group : to_plan.groups) begin(to_plan, group, to);
}

}  // namespace hapticd::control
