// What a disturbance observer leaves of a device's damping. In mode `model` it is a feedback of
// positions alone, added to a command path of gain 1 (control/observer/observer.h):
//
//   u = -H x,  H = G1 G2 (i (1 - 1/z)^2 + b (1 - 1/z)),  G = a / (1 - (1 - a)/z)
//
// i = inertia, b = damping of its plan [N/m]. A level D' is left if (Delta - D') + T H/(z - 1) is
// positive real. The difference in H takes the pole at 1 away,
//
//   T H/(z - 1) = T L,   L = G1 G2 (i (1 - 1/z) + b) / z,
//
// and both lags are stable, so the loss is T max -Re L on the unit circle. With u = cos wT
//
//   Re L = a1 a2 N(u) / (q1(u) q2(u)),  q = 1 - 2 (1 - a) u + (1 - a)^2 > 0,
//   N = Re (i (1 - 1/z) + b) (1 - c1 z) (1 - c2 z) / z,  c = 1 - a,
//
// so that "the loss is at most l" is "l q1 q2 + T a1 a2 N >= 0 on [-1, 1]", a quadratic in u: proved by
// its Bernstein coefficients. A blend in [0, 1] that stands still loses no more; one that moves, the
// limit of the output and gaps are outside of it. `classic` and `sensor` feed commands and the hand
// back: they leave nothing that could be claimed.
#pragma once
#include "control/observer/observer.h"

namespace hapticd::check {

/// Modes `classic` and `sensor`.
bool leaves_no_level(const control::ObserverPlan& observer);

/// N s/m or N m s/rad, >= 0: the observer takes no more of the damping. Infinite where nothing could
/// be shown. Mode `model` only.
double observer_loss(const control::ObserverPlan& observer, double period_s);

}  // namespace hapticd::check
