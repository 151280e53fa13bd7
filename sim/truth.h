// What really happened to a simulated device; no loop gets to see it. Works are since connect().
#pragma once
#include <algorithm>
#include <array>

namespace hapticd::sim {

/// Of an axis. Extremes are observed at sub-steps.
struct Truth {
  double position_m = 0;
  double velocity_m_s = 0;
  double min_position_m = 0;
  double max_position_m = 0;
  double effort_N = 0;        ///< that acted last
  double script_force_N = 0;  ///< that acted last; of a linkage: at its tip
  double rest_m = 0;          ///< of the hand's spring, now
  double effort_work_J = 0;   ///< that the actuator put into the axis
  double script_work_J = 0;   ///< that the hand's scripted force put in; 0 for a joint
  /// Kinetic, of the hand's spring and of the stops; kinetic alone where a hand is shared; 0 for a
  /// joint.
  double energy_J = 0;

  void observe(double at_m, double at_m_s) noexcept {
    position_m = at_m;
    velocity_m_s = at_m_s;
    min_position_m = std::min(min_position_m, at_m);
    max_position_m = std::max(max_position_m, at_m);
  }
};

/// Of a linkage as a whole, in the device frame. At every sub-step
///   energy_J - (energy at start) = sum of the joints' effort_work_J + hand_work_J - lost_J
struct TipTruth {
  std::array<double, 3> position_m{};
  std::array<double, 3> velocity_m_s{};
  double hand_work_J = 0;  ///< of the scripted force, and of moving the rest of the hand's spring
  double lost_J = 0;       ///< to friction, dampers and stops; never falls
  double energy_J = 0;     ///< kinetic, of the hand's spring and of the stops, and of height
};

}  // namespace hapticd::sim
