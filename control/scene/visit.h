// The contact law of one encounter, solved exactly with everything else held.
//
// With c where the proxy would be without this object, and `give` how it yields to a force, the
// proxy is y = c + give f. A body holds on to the contact at its own proxy z, a free point, by a
// spring of 1/compliance; so z = c + S f with S = give + compliance I, and f must be
//
//   frictionless   along the normal n at z, n.f >= 0
//   sticking       S^-1 (z_old - c), where that lies within the friction cone of n at z_old
//   sliding        with z on the way from the frictionless goal towards z_old, as far as the cone
//                  of the dynamic friction allows; put back on the surface where that is curved
//
// A surface's damper is a backward difference on the new normal, n.(y - y_last)/T, counted from the
// surface on and never pulling. It makes the spring stiffer and moves its rest along the normal.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// One contact in the tick that is being solved.
struct Visitor {
  const ContactPlan& contact;
  Vec3 last{};      ///< m: its proxy of the last tick, world
  Vec3 velocity{};  ///< m/s, by the axes' estimators: damps what is rendered directly
  bool directly = false;
  int max_turns = 12;  ///< of the search for a normal; others are visited again anyway: fewer
};

/// Sets at.next to the answer of the encounter; returns its force [N, world, on the contact].
/// `without` is c. Meshes and curves move their walk.
Vec3 visit(const Plan& plan, State& state, std::uint32_t encounter, const Visitor& visitor,
           const Vec3& without) noexcept;

/// The same for an encounter with a body.
Vec3 visit_body(const Plan& plan, State& state, std::uint32_t encounter, const Visitor& visitor,
                const Vec3& without) noexcept;

/// Energy [J] of an answer with the contact's proxy at `y`: the body's spring, or the field's
/// potential. `touch` is at.now or at.next. A body that moved on to where the old proxy stood
/// pushed it along (Touch::pushed).
double energy(const Plan& plan, const State& state, std::uint32_t encounter, const Touch& touch,
              const Vec3& y, const Vec3& last) noexcept;

/// The proxy of a touched body in the world [m], in this tick.
Vec3 proxy_in_world(const Plan& plan, const State& state, const Encounter& encounter,
                    const Touch& touch) noexcept;

/// What the object itself has put in since the last tick [J]: a path by moving the proxy that the
/// contact holds on to, with the contact's own proxy still at `last`; a vibration along the way to
/// `y`.
double injected(const Plan& plan, const State& state, std::uint32_t encounter,
                const EncounterState& at, const Vec3& last, const Vec3& y) noexcept;

/// S^-1 f for symmetric positive S, on the directions that the contact has; 0 in the others.
Vec3 solve_on(const ContactPlan& contact, const Mat3& s, const Vec3& f) noexcept;

}  // namespace hapticd::control
