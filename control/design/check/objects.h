// What bodies and fields ask of a contact that feels them directly, and of what kind they are.
//
// Weak convexity. U + (rho/2) |y|^2 is convex for a rho, exactly if the force -grad U, over any two
// points, does no more work than U loses plus (rho/2) |dy|^2. Bodies: 0 where they are convex. Fields:
// minus the least eigenvalue of the second derivative.
//   detents          steepest(), as the cosine is symmetric
//   constant field   steepest(): its second derivative is odd about the centre
//   magnet           along the radius 2 k at the end of the range, k = steepest(); across it, inside a
//                    ball of radius r > range, k (1 - s^2) p/(r - p) <= k (2 / 3 sqrt 3) range/(r - range)
// They are added up, all of a contact: who leaves one that pulls takes its energy along. A round body
// that is pressed p deep asks k p/(R - p), R its radius, k its stiffness: without end towards its
// centre, and nothing keeps a network from pressing that far. So bodies have none, nor have guides of
// a finite range, whose pull ends with a step.
#pragma once
#include "control/design/check/demand.h"

namespace hapticd::check {

/// Second derivative of the energy of objects, and their damping, in every direction alike.
struct ObjectShare {
  double stiffness = 0;  ///< N/m
  double damping = 0;    ///< N s/m
  double weakness = 0;   ///< N/m: rho; infinity: there is none
  ObjectShare& operator+=(const ObjectShare& other) {
    stiffness += other.stiffness;
    damping += other.damping;
    weakness += other.weakness;
    return *this;
  }
};

/// The most that the objects of one contact can ask together; sets `convex` to false where one of
/// them is not convex or has friction.
ObjectShare objects_of(const control::Plan& plan, const control::ContactPlan& contact,
                       bool& convex);

}  // namespace hapticd::check
