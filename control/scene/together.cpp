#include "control/scene/together.h"

#include <algorithm>

#include "control/scene/near.h"
#include "control/scene/visit.h"

namespace hapticd::control {
namespace {

void add_column(const Plan& plan, const Gain& column, double* out) noexcept {
  for (std::size_t i = 0; i < column.rows; ++i) out[i] += plan.gains[column.offset + i];
}

}  // namespace

Together::Together(const Plan& of_plan, State& of_state, std::size_t index) noexcept
    : plan(of_plan),
      state(of_state),
      group(of_plan.groups[index]),
      starts(of_state.mode != Mode::enabled),
      members(of_state.members.subspan(group.first_contact, group.contacts)),
      memory(of_state.coupling_memory.subspan(group.first_memory, group.memory)),
      network(of_state.network.subspan(group.first_state, group.states)),
      sweeps_left(group.max_sweeps) {
  gather();
  if (starts) begin();
}

void Together::gather() noexcept {
  for (std::size_t i = 0; i < group.contacts; ++i) {
    const std::size_t contact = plan.group_contacts[group.first_contact + i];
    Member& m = members[i];
    m.plan = &plan.contacts[contact];
    m.state = &state.contacts[contact];
    const double* coordinates = &state.x[m.plan->first_coordinate];
    std::copy_n(coordinates, m.plan->coordinates, &x[m.plan->first_row]);
    const Vec3 point = point_of(*m.plan, coordinates);
    update_near(plan, state, contact, point);
    near_count += m.state->near_count;
    m.last = starts ? point : m.state->proxy;
    m.bodies = {};
    m.changed = 0;
    m.slack = starts ? Vec3{} : m.state->slack;
    for_near(m, [&](std::uint32_t, EncounterState& at) {
      if (starts) at.now = {};
      at.next = at.now;
      m.bodies += at.next.force;
    });
  }
}

void Together::begin() noexcept {
  std::fill(memory.begin(), memory.end(), 0.0);
  std::fill(network.begin(), network.end(), 0.0);
  add_product(plan, group.begin, x.data(), network.data());
  add_column(plan, group.begin_rest, network.data());
}

void Together::free_proxies() noexcept {
  Rows through;
  Rows& x_free = group.reach.empty() ? y0 : through;
  for (const Member& m : members) {
    for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
      const std::size_t row = m.plan->first_row + i;
      x_free[row] = x[row] - m.slack[m.plan->direction[i]];
    }
  }
  add_product(plan, group.lag, memory.data(), x_free.data(), -1);
  if (group.reach.empty()) return;
  std::fill_n(y0.begin(), group.coordinates, 0.0);
  add_product(plan, group.reach, x_free.data(), y0.data());
  add_product(plan, group.sway, network.data(), y0.data(), -1);
  add_column(plan, group.rest, y0.data());
}

Vec3 Together::give(const Member& to, const Member& from, const Vec3& force) const noexcept {
  if (&to == &from) return to.plan->give * force;
  return block_times(plan, group, group.give, *to.plan, *from.plan, force);
}

void Together::place_proxies() noexcept {
  for (Member& to : members) {
    to.proxy = point_of(*to.plan, &y0[to.plan->first_row]);
    for (const Member& from : members) to.proxy += give(to, from, from.bodies);
  }
}

void Together::add_force(Member& at, const Vec3& change) noexcept {
  at.bodies += change;
  for (Member& to : members) to.proxy += give(to, at, change);
}

Rows Together::contact_force() const noexcept {
  Rows force;
  rows(force, [](const Member& m) { return m.bodies; });
  if (group.pull.empty()) return force;
  Rows y;
  rows(y, [](const Member& m) { return m.proxy; });
  add_column(plan, group.push, force.data());
  add_product(plan, group.pull, y.data(), force.data(), -1);
  add_product(plan, group.swing, network.data(), force.data(), -1);
  return force;
}

void Together::finish() noexcept {
  const Rows force = contact_force();
  Rows y;
  rows(y, [](const Member& m) { return m.proxy; });
  for (Member& m : members) {
    const std::size_t first = m.plan->first_coordinate;
    for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
      state.proxy[first + i] = y[m.plan->first_row + i];
      state.scene_force[first + i] += force[m.plan->first_row + i];
    }
    state.solve_error[m.plan->device] = m.changed;
    for_near(m, [&](std::uint32_t encounter, EncounterState& at) {
      state.injected[m.plan->device] += injected(plan, state, encounter, at, m.last, m.proxy);
      at.now = at.next;
    });
    m.state->proxy = m.proxy;
    m.state->slack = m.slack;
  }
  remember(y, force);
}

void Together::remember(const Rows& y, const Rows& force) noexcept {
  std::array<double, kMaxGroupStates> next;
  if (group.remembers_stretch) {
    for (const Member& m : members) {
      for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
        const std::size_t row = m.plan->first_row + i;
        memory[row] = x[row] - m.slack[m.plan->direction[i]] - y[row];
      }
    }
  } else if (group.memory > 0) {
    std::fill_n(next.begin(), group.memory, 0.0);
    add_product(plan, group.recall, memory.data(), next.data());
    add_product(plan, group.learn, force.data(), next.data(), -1);
    std::copy_n(next.begin(), group.memory, memory.begin());
  }
  if (group.states == 0) return;
  std::fill_n(next.begin(), group.states, 0.0);
  add_product(plan, group.sway_on, network.data(), next.data());
  add_product(plan, group.drive, y.data(), next.data());
  add_column(plan, group.drift, next.data());
  std::copy_n(next.begin(), group.states, network.begin());
}

}  // namespace hapticd::control
