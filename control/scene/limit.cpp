#include "control/scene/limit.h"

#include <algorithm>
#include <cmath>

#include "control/scene/sweep.h"

namespace hapticd::control {
namespace {

constexpr double kReached = 1e-10;  ///< of the limit: this near to it the slack is right

/// What the search knows of one contact.
struct Slope {
  double stiffness = 0;  ///< N/m: how the force grows with the contact's position
  double force = 0;      ///< N, one step ago
  double slack = 0;      ///< m, one step ago
};

/// At least the stiffness that the contact can feel [N/m].
double steepest(const Together& together, const Member& m) noexcept {
  const double* hold = together.plan.gains.data() + together.group.hold.offset;
  double sum = 0;
  for (std::size_t i = 0; i < m.plan->coordinates; ++i) {
    const std::size_t row = m.plan->first_row + i;
    sum += hold[row * together.group.coordinates + row];
  }
  return sum > 0 ? sum : 1;
}

/// One proximal step on F_max |s|: the slack that would balance a contact of that stiffness. The
/// stiffness is a secant's from the second step on, so that few steps do. True: it moved.
bool adjust(const Together& together, Member& m, const Vec3& force, Slope& slope) noexcept {
  const double most = force_limit(*m.plan);
  const double found = norm(force), slack = norm(m.slack);
  if (slack == 0 ? !(found > most) : std::abs(found - most) <= kReached * most) return false;
  const double bound = steepest(together, m);
  if (slope.stiffness == 0 || slack == slope.slack) {
    slope.stiffness = bound;
  } else {
    const double secant = std::abs((found - slope.force) / (slack - slope.slack));
    slope.stiffness = std::clamp(secant, 1e-6 * bound, bound);
  }
  slope.force = found;
  slope.slack = slack;
  const Vec3 way = m.slack - (1 / slope.stiffness) * force;
  const double length = norm(way);
  const double left = length - most / slope.stiffness;
  const Vec3 before = m.slack;
  m.slack = left > 0 ? (left / length) * way : Vec3{};
  return m.slack != before;
}

}  // namespace

double force_limit(const ContactPlan& contact) noexcept {
  return (1 - 1e-6) * contact.max_force;
}

void solve_within_limits(Together& together) noexcept {
  std::array<Slope, kMaxDevices> slopes{};
  for (;;) {
    sweep(together);
    if (together.sweeps_left == 0) return;
    const Rows force = together.contact_force();
    bool moved = false;
    for (std::size_t c = 0; c < together.group.contacts; ++c) {
      Member& m = together.members[c];
      moved |= adjust(together, m, vector_of(*m.plan, &force[m.plan->first_row]), slopes[c]);
    }
    if (!moved) return;
  }
}

}  // namespace hapticd::control
