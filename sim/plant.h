// One axis as it really moves: a mass with damper, a hand held rigidly on it, and Coulomb friction.
//
//   M x'' = f - d x' - k (x - r(t)) + friction + stops
//
// M = m + m_hand, d = b + b_hand (the hand's damper goes to ground), k the hand's spring, r where
// that wants to be.
//
// Between two changes of f (held) and of the slope of r (linear) the solution is a matrix
// exponential, so nothing is lost to integration whatever the interval. Friction and stops are
// constant over an interval (see Plant::advance).
#pragma once
#include "sim/end_stops.h"

namespace hapticd::sim {

struct PlantOptions {
  double mass_kg = 0;        ///< > 0, the hand's included
  double damping_Ns_m = 0;   ///< >= 0, the hand's included
  double stiffness_N_m = 0;  ///< >= 0, the hand's spring
  double coulomb_N = 0;      ///< >= 0
  EndStops stops{};
};

/// What acts on the mass over one interval.
struct PlantInput {
  double force_N = 0;        ///< held
  double rest_m = 0;         ///< of the spring, when the interval begins
  double rest_rate_m_s = 0;  ///< held
};

/// How far (x, v) move over one interval of fixed length; made at set-up, used in the loop. Each
/// coefficient is the change of position (x_) or velocity (v_) per unit of: displacement from the
/// spring's rest at the start (_y), velocity at the start (_v), held force (_f), force growing from
/// zero at 1 N/s (_s).
struct Propagator {
  double length_s = 0;
  double x_y = 0, x_v = 0, x_f = 0, x_s = 0;
  double v_y = 0, v_v = 0, v_f = 0, v_s = 0;
};

class Plant {
 public:
  /// At rest at `position_m`.
  Plant(const PlantOptions& options, double position_m) noexcept
      : options_(options), position_m_(position_m) {}

  /// For intervals of `length_s` > 0. Set-up only.
  Propagator propagator(double length_s) const;

  /// Moves on by one interval. Friction is a force held over the interval that may stop the mass
  /// but never turns it round, and its work is never positive: so it only ever takes energy. So do
  /// stops, but for what their springs hold.
  void advance(const Propagator& propagator, const PlantInput& input) noexcept;

  double position_m() const noexcept { return position_m_; }
  double velocity_m_s() const noexcept { return velocity_m_s_; }
  /// With `force_N` acting and the hand's spring at rest at `rest_m`.
  double acceleration_m_s2(double force_N, double rest_m) const noexcept;
  /// Kinetic energy, that of the stops and that of the hand's spring at rest at `rest_m`.
  double energy_J(double rest_m) const noexcept;
  void set_velocity(double velocity_m_s) noexcept { velocity_m_s_ = velocity_m_s; }

 private:
  bool sticks(const Propagator& propagator, const PlantInput& input) const noexcept;
  double stop_N(const Propagator& propagator, double free_step_m) const noexcept;
  double friction_N(const Propagator& propagator, double free_step_m,
                    double stopping_N) const noexcept;

  PlantOptions options_;
  double position_m_ = 0;
  double velocity_m_s_ = 0;
};

}  // namespace hapticd::sim
