// Dispatch on the kind of an object: the only place in the loop that lists them all.
#pragma once
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

/// nearest() of the body of an encounter, in the object's frame. `touching`: it was touched in the
/// last tick, so that a mesh goes on from there.
Nearest nearest_free(const Plan& plan, State& state, const Encounter& encounter, bool touching,
                     const Vec3& point, const Vec3& from, double radius) noexcept;

/// evaluate() of the field of an encounter, in the object's frame.
FieldValue ask_field(const Plan& plan, const Encounter& encounter, const Vec3& y, const Vec3& step,
                     double time_s) noexcept;

}  // namespace hapticd::control
