// The closed forms: Theorems A, A' and B for springs and dampers on devices whose Jacobian is
// constant, and the condition in joint space (poses.h) for the others.
#pragma once
#include "control/design/check/tied_case.h"

namespace hapticd::check {

/// `limit`: share of the damping that may be used, at most 1. Everything of the answer but what
/// concerns single objects and what is never covered.
PassiveAnswer closed_form(const TiedCase& given, double limit);
/// Likewise, where a device's Jacobian depends on its pose.
PassiveAnswer joint_space_form(const TiedCase& given, double limit);

}  // namespace hapticd::check
