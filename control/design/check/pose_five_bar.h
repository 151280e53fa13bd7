// The five-bar over its joint angles (control/kinematics/five_bar.cpp): with D = E2 - E1
//
//   P = (E1 + E2) / 2 + w (-Dy, Dx),   w^2 = l^2 / |D|^2 - 1/4
//
// With m_i = r_i . dE_i/dq_i, J^-1 = diag(1/m_1, 1/m_2) [r_1'; r_2'] has the Frobenius norm
// l sqrt(1/m_1^2 + 1/m_2^2) and the determinant |D| h / (m_1 m_2), so
//
//   kappa = |J^-1|_F^2 / |det J^-1| = l^2 (m_1/m_2 + m_2/m_1) / (|D| h) >= 2 l^2 / (|D| h),
//   (|D| h)^2 = |D|^2 (l^2 - |D|^2 / 4), at most l^4, where |D|^2 = 2 l^2
//
// which tells that a cell is singular even where second derivatives have no bound.
#pragma once
#include "control/design/check/pose_joints.h"

namespace hapticd::check {

class FiveBarCells {
 public:
  explicit FiveBarCells(const control::FiveBar& bars) : bars_(bars) {}
  JointCell look(const PoseChart& chart, const Cell& cell) const;

 private:
  using Jet2 = Jet<2>;
  struct Place {
    Interval apart2;  ///< |D|^2
    Jet2 x, y;        ///< tip, device frame
  };
  Place place(const std::array<Interval, 2>& q) const;
  bool is_singular(const PoseChart& chart, Interval apart2) const;

  const control::FiveBar& bars_;
};

}  // namespace hapticd::check
