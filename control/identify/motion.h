// One axis in motion, exactly, while a force is held:
//
//   m x'' = F - b x' - c sgn(x'),   at rest as long as |F| <= c
//
// Between two reversals this is linear, and velocity is monotonic, so a reversal or a stop is found
// in closed form: with a the acceleration at the start, b x' included, velocity w is reached at
// t = -(m/b) ln(1 - (b/m) (w - v)/a).
//
// Friction may turn round a moment after the motion does, or before: asperities bend before they
// slide (presliding), and a simulator with steps of its own is no more exact. That moment, `lag_s`,
// is small against a period, but not against how well the mass can be told.
#pragma once

namespace hapticd::identify {

/// What an axis is made of. Mass and force stand for inertia and torque of a rotary axis.
struct Dynamics {
  double mass = 0;     ///< kg or kg m^2, > 0
  double viscous = 0;  ///< N s/m or N m s/rad, >= 0
  double coulomb = 0;  ///< N or N m, >= 0
  double delay_s = 0;  ///< from the sample that an effort answers to the force at the axis, >= 0
  double bias = 0;     ///< N or N m: constant force beside the effort, such as weight
  double lag_s = 0;    ///< from a reversal to that of friction
};

struct Motion {
  double position = 0;
  double velocity = 0;
  double friction = 0;  ///< +1, -1: friction is that of this direction; 0: the axis rests
};

/// How mass and damper move over an interval: v' = decay v + drift a, dx = drift v + fall a with
/// a = F/m at its start.
struct Interval {
  double length_s = 0;
  double decay = 1;
  double drift = 0;  ///< s
  double fall = 0;   ///< s^2
};
Interval interval(const Dynamics& axis, double length_s) noexcept;

/// Moves on by `step` = interval(axis, ...) under `force`, the bias included.
void advance(const Dynamics& axis, const Interval& step, double force, Motion& motion) noexcept;

}  // namespace hapticd::identify
