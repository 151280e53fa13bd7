#include "control/identify/motion.h"

#include <algorithm>
#include <cmath>

namespace hapticd::identify {
namespace {

void glide(const Interval& step, double acceleration, Motion& motion) noexcept {
  motion.position += step.drift * motion.velocity + step.fall * acceleration;
  motion.velocity = step.decay * motion.velocity + step.drift * acceleration;
}

/// Time to velocity `to`; 0 if it is passed.
double time_to_s(const Dynamics& axis, double velocity, double acceleration, double to) noexcept {
  const double undamped_s = (to - velocity) / (acceleration - axis.viscous / axis.mass * velocity);
  if (!(undamped_s > 0)) return 0;
  const double rate = axis.viscous / axis.mass;
  return rate * undamped_s > 1e-12 ? -std::log1p(-rate * undamped_s) / rate : undamped_s;
}

}  // namespace

// With z = b h / m: decay e^-z, drift h (1 - e^-z)/z, fall h^2 (1 - (1 - e^-z)/z)/z; by series where
// the differences would cancel.
Interval interval(const Dynamics& axis, double length_s) noexcept {
  const double h = length_s, z = axis.viscous * h / axis.mass;
  if (z < 1e-3) {
    return {.length_s = h,
            .decay = std::exp(-z),
            .drift = h * (1 - z / 2 * (1 - z / 3 * (1 - z / 4))),
            .fall = h * h / 2 * (1 - z / 3 * (1 - z / 4 * (1 - z / 5)))};
  }
  const double drift = -std::expm1(-z) / z;
  return {
      .length_s = h, .decay = std::exp(-z), .drift = h * drift, .fall = h * h * (1 - drift) / z};
}

void advance(const Dynamics& axis, const Interval& step, double force, Motion& motion) noexcept {
  const bool held = std::abs(force) <= axis.coulomb;
  if (motion.friction == 0) {
    if (held) return;
    motion.friction = std::copysign(1.0, force);
  }
  const double acceleration = (force - axis.coulomb * motion.friction) / axis.mass;
  if (acceleration * motion.friction >= 0) return glide(step, acceleration, motion);
  const double turn =
      held ? 0 : acceleration * axis.lag_s;  // velocity at which friction turns round
  const double velocity = step.decay * motion.velocity + step.drift * acceleration;
  if ((velocity - turn) * motion.friction > 0) return glide(step, acceleration, motion);
  const double turn_s =
      std::min(step.length_s, time_to_s(axis, motion.velocity, acceleration, turn));
  glide(interval(axis, turn_s), acceleration, motion);
  motion.friction = held ? 0 : std::copysign(1.0, force);
  if (held) {
    motion.velocity = 0;
  } else {
    glide(interval(axis, step.length_s - turn_s),
          (force - axis.coulomb * motion.friction) / axis.mass, motion);
  }
}

}  // namespace hapticd::identify
