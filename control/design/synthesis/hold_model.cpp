#include "control/design/synthesis/hold_model.h"

#include <cmath>
#include <numbers>

namespace hapticd::synthesis {
namespace {

double corner(const HoldModel& hold, double period_s) {
  if (hold.kind == Hold::adams_hannaford) return 2 / period_s;
  if (hold.corner_rad_s > 0) return hold.corner_rad_s;
  return (hold.kind == Hold::second_order ? std::numbers::pi : 2) / period_s;
}

}  // namespace

std::optional<Rational> rational(const HoldModel& hold, double period_s) {
  const double lag_s = 1 / corner(hold, period_s);
  switch (hold.kind) {
    case Hold::none:
      return Rational{Vector::Ones(1), Vector::Ones(1)};
    case Hold::adams_hannaford:
    case Hold::first_order:
      return Rational{Vector::Ones(1), Eigen::Vector2d(1, lag_s)};
    case Hold::second_order:
      return Rational{Vector::Ones(1),
                      Eigen::Vector3d(1, 2 * hold.damping_ratio * lag_s, lag_s * lag_s)};
    default:
      return std::nullopt;
  }
}

Complex at(const HoldModel& hold, Complex s, double period_s) {
  const Complex turn = s * period_s;
  switch (hold.kind) {
    case Hold::zero_order:
      // The series where the difference of the two would lose digits.
      if (std::abs(turn) < 1e-4) return 1.0 - turn / 2.0 + turn * turn / 6.0;
      return (1.0 - std::exp(-turn)) / turn;
    case Hold::delay:
      return std::exp(-0.5 * turn);
    case Hold::average:
      return 0.5 * (1.0 + std::exp(-turn));
    default:
      return at(*rational(hold, period_s), s);
  }
}

double added_damper(const HoldModel& hold, double stiffness, double period_s) {
  return hold.kind == Hold::adams_hannaford ? 0.5 * stiffness * period_s : 0;
}

}  // namespace hapticd::synthesis
