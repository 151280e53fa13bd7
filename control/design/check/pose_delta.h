// The delta over places of its tip, where the joint angles are explicit functions q_i(p)
// (control/kinematics/delta.cpp):
//
//   q_i = direction(w, X) - arccos((X^2 + w^2 + a^2 - L^2) / (2 a rho)),  A = dq/dp = J^-1
//
// Along a straight line in joint space A p'' + d2q/dp2 [p', p'] = 0, so |p''| <= |J d2q/dp2| |p'|^2.
// Scaled, J~ = (D^(1/2) A)^-1; over a cell with a margin that a step cannot leave,
// |A - A(middle)| <= E by intervals of d2q/dp2, and with e = |D^(1/2) E| |J~(middle)| < 1
//
//   |S J~| <= |S J~(middle)| / (1 - e),    |f.d2x/dq2 [v, v]| <= F |J~|^3 |D^(1/2) d2q/dp2| v'D v
//
// The margin m holds if |J| times the longest step of the joints stays below it.
#pragma once
#include "control/design/check/pose_chart.h"

namespace hapticd::check {

class DeltaChart : public PoseChart {
 public:
  DeltaChart(const PoseChart& chart, const control::Delta& delta);
  CellVerdict operator()(const Cell& cell) const;
  /// A box that has every place of the tip that the guards let pass.
  Cell reachable() const;

 private:
  using Jet3 = Jet<3>;
  struct Legs {
    bool no_pose = false;
    std::array<Jet3, 3> angle;
  };
  Legs legs(const std::array<Interval, 3>& tip) const;
  Eigen::Matrix3d middle_slopes(const std::array<double, 3>& tip) const;
  void judge(const std::array<double, 3>& tip, const ChartVector& half, CellVerdict& verdict) const;

  const control::Delta& delta_;
  double longest_step_;    ///< norm over the joints
  Eigen::Matrix3d weigh_;  ///< S turn, filled up with zeros
};

}  // namespace hapticd::check
