#include "control/scene/descent.h"

#include <algorithm>
#include <cmath>

#include "control/scene/limit.h"
#include "control/scene/visit.h"

namespace hapticd::control {
namespace {

constexpr double kEnergyRounding = 1e-12;  ///< of the energies that are compared

/// J but for what does not depend on the proxies [J]; y0 is that of their slack.
double energy_of(Together& together, Touch EncounterState::*which) noexcept {
  Rows off;
  together.rows(off, [](const Member& m) { return m.proxy; });
  for (std::size_t i = 0; i < together.group.coordinates; ++i) off[i] -= together.y0[i];
  double sum = 0.5 * quadratic(together.plan, together.group.hold, off.data());
  for (const Member& m : together.members) {
    sum += force_limit(*m.plan) * norm(m.slack);
    together.for_near(m, [&](std::uint32_t encounter, const EncounterState& at) {
      sum += energy(together.plan, together.state, encounter, at.*which, m.proxy, m.last);
    });
  }
  return sum;
}

bool is_coupled(const Together& together, std::size_t row) noexcept {
  const std::size_t diagonal = row * together.group.coordinates + row;
  return together.plan.gains[together.group.hold.offset + diagonal] != 0;
}

/// Proxies and slack of the last tick; coordinates that nothing holds are where the contact is.
void go_back(Together& together) noexcept {
  for (Member& m : together.members) m.slack = together.starts ? Vec3{} : m.state->slack;
  for (Member& m : together.members) {
    m.proxy = m.last;
    for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
      const std::size_t row = m.plan->first_row + i, direction = m.plan->direction[i];
      if (!is_coupled(together, row)) m.proxy[direction] = together.x[row] - m.slack[direction];
    }
  }
}

/// Under latency: (g/2) |y - y_last|^2_K.
double price(const Together& together) noexcept {
  if (!(together.group.sharpen > 0)) return 0;
  Rows way;
  together.rows(way, [](const Member& m) { return m.proxy - m.last; });
  return 0.5 * together.group.sharpen *
         quadratic(together.plan, together.group.stiffness, way.data());
}

}  // namespace

bool descends(Together& together) noexcept {
  const auto is_slack = [](const Member& m) {
    return m.slack != Vec3{} || m.state->slack != Vec3{};
  };
  const bool limited = std::any_of(together.members.begin(), together.members.end(), is_slack);
  // Without bodies y0 is the minimum itself; under latency the way there has to be paid for too.
  if (together.near_count == 0 && !limited && !(together.group.sharpen > 0)) return true;
  const double found = energy_of(together, &EncounterState::next) + price(together);
  for (Member& m : together.members) {
    m.found_proxy = m.proxy;
    m.found_slack = m.slack;
  }
  go_back(together);
  if (limited) together.free_proxies();
  const double old = energy_of(together, &EncounterState::now);
  const bool down = found <= old + kEnergyRounding * (std::abs(found) + std::abs(old));
  if (!down) return false;
  for (Member& m : together.members) {
    m.proxy = m.found_proxy;
    m.slack = m.found_slack;
  }
  return true;
}

void stay(Together& together) noexcept {
  go_back(together);
  for (Member& m : together.members) {
    m.bodies = {};
    together.for_near(m, [&](std::uint32_t encounter, EncounterState& at) {
      const Encounter& e = together.plan.encounters[encounter];
      const Visitor visitor{.contact = *m.plan, .last = m.last, .directly = true};
      if (is_field(e.kind)) {
        visit(together.plan, together.state, encounter, visitor, m.proxy);
      } else {
        at.next = at.now;
        const Vec3 z = proxy_in_world(together.plan, together.state, e, at.now);
        at.next.force = at.now.touching ? (1 / e.surface.compliance) * (z - m.proxy) : Vec3{};
      }
      m.bodies += at.next.force;
    });
  }
  // What holds the proxies there is the coupling's force, whatever the bodies' laws say.
  together.free_proxies();
  Rows off, held{};
  together.rows(off, [](const Member& m) { return m.proxy; });
  for (std::size_t i = 0; i < together.group.coordinates; ++i) off[i] -= together.y0[i];
  add_product(together.plan, together.group.hold, off.data(), held.data());
  for (Member& m : together.members) {
    const Vec3 laws = m.bodies;
    for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
      const std::size_t row = m.plan->first_row + i;
      if (is_coupled(together, row)) m.bodies[m.plan->direction[i]] = held[row];
    }
    m.changed = norm(m.bodies - laws);
  }
}

}  // namespace hapticd::control
