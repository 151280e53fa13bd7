// Where a contact meets an object, and where it is rid of it, for `hapticctl cost`.
#pragma once
#include <optional>

#include "control/build/program.h"

namespace hapticd::daemon {

/// How deep a contact is put into a body, how far from a guide [m]; half the depth that there is in
/// what is thinner.
inline constexpr double kTouchDepth_m = 1e-3;

/// A place, and the way a contact goes to and fro there: at +- amplitude along.
struct Stand {
  Vec3 at{};     ///< m, world; in directions that the contact does not have: where it stays
  Vec3 along{};  ///< unit
  double amplitude = 0.5 * kTouchDepth_m;
};

/// In the object of an encounter: a representative point of its surface (of a mesh near a vertex),
/// about a millimetre deep, at time 0. None: the contact cannot get there.
std::optional<Stand> touching_stand(build::Program& program, const control::Encounter& encounter);

/// A metre away from it. None: it is felt everywhere.
std::optional<Stand> distant_stand(const build::Program& program,
                                   const control::Encounter& encounter);

/// In a plane that is rendered directly (control/scene/plane.h), and the contact that feels it:
/// coordinate i stands for direction i.
Stand touching_stand(const control::PlaneContact& plane);
control::ContactPlan contact_of(const control::PlaneContact& plane);

/// `at` with what the contact cannot do left out.
Vec3 reached(const control::ContactPlan& contact, const Vec3& at);

}  // namespace hapticd::daemon
