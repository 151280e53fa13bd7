// Serial chains over their joints (control/kinematics/serial.cpp). With z_j, o_j axis and place of
// joint j and p the tip, for i <= j
//
//   d2p / dq_i dq_j = z_i x (z_j x (p - o_j))  both turn        no longer than |J_j|
//                     z_i x z_j                j slides         no longer than 1
//                     0                        i slides
//
// |J_j| is the distance of the tip from axis j: at most a_j + sum_{k>j} |link k|, or, nearer to what
// it is in the middle of a cell, |J_j(middle)| + sum_i N_ij r_i. The links' weight, held by the
// motors, is a potential whose second derivatives are bounded in the same way.
#pragma once
#include "control/design/check/pose_joints.h"

namespace hapticd::check {

class SerialCells {
 public:
  explicit SerialCells(const control::Serial& chain) : chain_(chain) {}
  JointCell look(const PoseChart& chart, const Cell& cell) const;

 private:
  /// m: distance of anything up to link `last` from axis j, at most; sliding joints reach `slide`.
  double farthest(std::size_t j, std::size_t last,
                  const std::array<double, kMaxJoints>& slide) const;
  double load(const std::array<double, kMaxJoints>& slide) const;
  /// N from bounds of the columns of J.
  ChartMatrix curvature(const std::array<double, kMaxJoints>& columns) const;

  const control::Serial& chain_;
};

}  // namespace hapticd::check
