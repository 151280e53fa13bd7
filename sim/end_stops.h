// The two mechanical ends of an axis: lossy springs that only push. At depth p >= 0
//
//   F = max(0, k p + c p')
//
// k: the actuator's largest effort goes in by a thousandth of the travel. c is half of critical, so
// that three tenths of the speed come back.
#pragma once
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "sim/options.h"

namespace hapticd::sim {

struct EndStops {
  double min_m = -std::numeric_limits<double>::infinity();
  double max_m = std::numeric_limits<double>::infinity();
  double stiffness_N_m = 0;
  double damping_Ns_m = 0;

  /// > 0 beyond max, < 0 beyond min, 0 between.
  double depth_m(double position_m) const noexcept {
    if (position_m > max_m) return position_m - max_m;
    return position_m < min_m ? position_m - min_m : 0.0;
  }
  double force_N(double position_m, double velocity_m_s) const noexcept {
    const double depth = depth_m(position_m);
    if (depth == 0) return 0;
    const double force = -stiffness_N_m * depth - damping_Ns_m * velocity_m_s;
    return depth > 0 ? std::min(force, 0.0) : std::max(force, 0.0);
  }
  double energy_J(double position_m) const noexcept {
    const double depth = depth_m(position_m);
    return 0.5 * stiffness_N_m * depth * depth;
  }
};

/// `mass_kg` is what runs into them; `most_N_m` bounds the stiffness, where it has to be resolved.
inline EndStops end_stops(const AxisOptions& axis, double mass_kg, double most_N_m) noexcept {
  if (!axis.stops) return {};
  constexpr double kShareOfTravel = 1e-3;
  const double travel_m = axis.stops->max_m - axis.stops->min_m;
  const double k = std::min(axis.max_effort_N / (kShareOfTravel * travel_m), most_N_m);
  return {axis.stops->min_m, axis.stops->max_m, k, std::sqrt(k * mass_kg)};
}

}  // namespace hapticd::sim
