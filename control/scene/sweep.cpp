#include "control/scene/sweep.h"

#include <algorithm>

#include "control/scene/active_set.h"
#include "control/scene/visit.h"

namespace hapticd::control {
namespace {

/// Visits every near encounter once. How many there are.
std::size_t visit_all(Together& together) noexcept {
  std::size_t visited = 0;
  for (Member& m : together.members) {
    m.changed = 0;
    const int turns = m.state->near_count > 1 ? 2 : 12;
    const Visitor visitor{.contact = *m.plan, .last = m.last, .max_turns = turns};
    together.for_near(m, [&](std::uint32_t encounter, EncounterState& at) {
      const Vec3 before = at.next.force;
      const Vec3 without = m.proxy - m.plan->give * before;
      const Vec3 change =
          visit(together.plan, together.state, encounter, visitor, without) - before;
      m.changed = std::max(m.changed, norm(change));
      together.add_force(m, change);
      ++visited;
    });
  }
  return visited;
}

/// A body that pushes without friction.
struct BodyPush {
  Touch* touch = nullptr;
  Member* member = nullptr;
  Vec3 normal{};
};

/// A Newton step on all pushes at once (active_set.h).
void balance(Together& together) noexcept {
  ActiveSet set;
  std::array<BodyPush, kMaxActive> pushes;
  for (Member& m : together.members) {
    together.for_near(m, [&](std::uint32_t encounter, EncounterState& at) {
      const Encounter& e = together.plan.encounters[encounter];
      const double force = norm(at.next.force);
      if (is_field(e.kind) || e.surface.static_friction > 0 || !(force > 0)) return;
      if (set.count < kMaxActive) {
        pushes[set.count] = {&at.next, &m, (1 / force) * at.next.force};
        set.force[set.count] = force;
      }
      ++set.count;
    });
  }
  if (set.count < 2 || set.count > kMaxActive) return;
  for (std::size_t i = 0; i < set.count; ++i) {
    const auto& [touch, member, normal] = pushes[i];
    set.miss[i] = touch->rest - dot(normal, member->proxy) - touch->yields * set.force[i];
    for (std::size_t j = 0; j <= i; ++j)
      set.give[i][j] = dot(normal, together.give(*member, *pushes[j].member, pushes[j].normal));
    set.give[i][i] += touch->yields;
  }
  if (!set.solve()) return;
  for (std::size_t i = 0; i < set.count; ++i) {
    const Vec3 force = set.force[i] * pushes[i].normal;
    together.add_force(*pushes[i].member, force - pushes[i].touch->force);
    pushes[i].touch->force = force;
  }
}

/// Until no force changes any more. False: once was enough.
bool sweep_until_still(Together& together) noexcept {
  while (together.sweeps_left > 0) {
    --together.sweeps_left;
    const std::size_t visited = visit_all(together);
    double changed = 0;
    for (const Member& m : together.members) changed = std::max(changed, m.changed);
    if (visited <= 1) return false;  // exact at once
    if (!(changed > together.group.tolerance)) break;
    balance(together);
  }
  return true;
}

/// Forces and proxies anew from their parts: a sweep only adds changes, and some of those may have
/// been large.
void add_up(Together& together) noexcept {
  for (Member& m : together.members) {
    m.bodies = {};
    together.for_near(m,
                      [&](std::uint32_t, const EncounterState& at) { m.bodies += at.next.force; });
  }
  together.place_proxies();
}

}  // namespace

void sweep(Together& together) noexcept {
  together.free_proxies();
  together.place_proxies();
  if (together.near_count > 0 && sweep_until_still(together)) add_up(together);
}

}  // namespace hapticd::control
