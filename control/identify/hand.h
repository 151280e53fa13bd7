// What a hand on an axis is to small motions, out of the force that a sensor measures between the
// two: mass, damper and spring to where the hand wants to be,
//
//   -F = m a + b v + k (x - r)
//
// At each frequency of a stepped sine this is one complex equation for each block, linear in m, b and
// k. Derivatives are exact differences: (x_k+1 - 2 x_k + x_k-1)/T^2 is the mean of the acceleration
// with weights falling off to a period on either side, so it differs from a at the sample by what the
// held effort's steps do there, whose shape is known from the effort and the delay, and whose share
// m/(mass of all) is a fourth unknown.
#pragma once
#include <span>
#include <vector>

#include "control/core/result.h"
#include "control/identify/response.h"

namespace hapticd::identify {

struct HandOptions {
  double delay_s = 0;  ///< of the axis: sample to force
};

/// Mass in kg, viscous damping in N s/m, stiffness in N/m; of a rotary axis in kg m^2, N m s/rad,
/// N m/rad.
struct HandImpedance {
  double mass = 0;
  double viscous = 0;
  double stiffness = 0;
};

struct HandFit {
  HandImpedance value;
  HandImpedance half_width;  ///< of the 99 % intervals
  std::vector<ResponsePoint> force_per_position;
};

/// `force` of the hand on the axis, a value for each sample of the record [N or N m]. Errors (no):
/// fewer than four frequencies with motion, or no force.
Result<HandFit> fit_hand(const Record& record, const Signal& force,
                         std::span<const Measured> measured, const HandOptions& options);

}  // namespace hapticd::identify
