// Charts over joints, where the contact is an explicit function of them: serial chains and the
// five-bar. With N_ij >= |d2x/dq_i dq_j| over a cell and a step's length around it and r_j the cell's
// half width and the step,
//
//   |J_j(q) - J_j(middle)| <= sum_i N_ij r_i =: e_j        |S J~| <= |S J~(middle)| + |S| |e~|
//   |f . d2x/dq2 [v, v]| <= F |N~| v'D_q v,                N~ = D_q^(-1/2) N D_q^(-1/2)
#pragma once
#include "control/design/check/pose_chart.h"

namespace hapticd::check {

/// What a kind of linkage knows of a cell.
struct JointCell {
  bool no_pose = false;            ///< nowhere in it
  bool singular = false;           ///< the guard bites everywhere in it, as the kind knows
  bool has_middle = false;         ///< x and J are known
  std::array<double, 3> x{};       ///< contact coordinates at the middle
  ChartMatrix jacobian;            ///< there, coordinates x axes
  ChartMatrix curvature;           ///< N, infinite where nothing is known; scale included
  std::array<Interval, 3> places;  ///< of the contact over the cell
  double load = 0;                 ///< N m: bound of the second derivative of what links weigh
};

/// `Kind` has `JointCell look(const Cell&, const ChartVector& steps) const`.
template <class Kind>
class JointChart : public PoseChart {
 public:
  JointChart(const PoseChart& chart, const Kind& kind) : PoseChart(chart), kind_(kind) {}

  CellVerdict operator()(const Cell& cell) const {
    const JointCell seen = kind_.look(*this, cell);
    CellVerdict verdict;
    verdict.outside = seen.no_pose || seen.singular || !may_be_in_box(seen.places);
    if (verdict.outside || !seen.has_middle) return verdict;
    const ChartMatrix scaled = seen.jacobian * spread_.asDiagonal();
    const double asked = spectral(S_ * scaled);
    if (is_guarded(seen.x, seen.jacobian)) {
      verdict.found = asked * asked;
      verdict.pose = seen.x;
    }
    if (!seen.curvature.allFinite()) return verdict;
    judge(cell, seen, asked, verdict);
    return verdict;
  }

 private:
  void judge(const Cell& cell, const JointCell& seen, double asked, CellVerdict& verdict) const {
    const Eigen::Index n = seen.curvature.rows();
    ChartVector half(n);
    for (Eigen::Index i = 0; i < n; ++i) half[i] = cell.half(static_cast<std::size_t>(i));
    if (is_surely_singular(seen.jacobian, (seen.curvature * half).norm())) {
      verdict.outside = true;
      return;
    }
    const ChartVector change = seen.curvature * (half + steps_);
    const double springs = asked + stiffest_ * change.cwiseProduct(spread_).norm();
    const ChartMatrix bent = spread_.asDiagonal() * seen.curvature * spread_.asDiagonal();
    verdict.bending = (bending_ * spectral(bent) +
                       0.5 * plan_.period_s * seen.load * squared(spread_.maxCoeff())) *
                      kDenseMargin;
    verdict.bound = squared(springs) * kDenseMargin + verdict.bending;
  }

  const Kind& kind_;
};

}  // namespace hapticd::check
