// What the charts of all kinds of linkages share: weights, guards, and what a cell asks of the
// damping once J at its middle and bounds of its change are known.
//
// In scaled joints, q~ = D_q^(1/2) q, J~ = J D_q^(-1/2), the share that springs and dampers ask is
// |S J~|^2, S'S = W.
#pragma once
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <optional>

#include "control/core/algebra.h"
#include "control/design/check/interval.h"
#include "control/design/check/pose_cells.h"
#include "control/design/check/poses.h"
#include "control/kinematics/reach.h"

namespace hapticd::check {

/// Rounding of the small dense algebra, taken off every bound.
inline constexpr double kDenseMargin = 1 + 1e-9;

/// Rows or columns of a chart: at most three coordinates, at most kMaxJoints joints.
using ChartMatrix =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxJoints, kMaxJoints>;
using ChartVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;

/// Largest singular value.
inline double spectral(const ChartMatrix& m) {
  ChartMatrix gram;
  if (m.rows() < m.cols()) {
    gram = m * m.transpose();
  } else {
    gram = m.transpose() * m;
  }
  return std::sqrt(std::max(0.0, algebra::symmetric_eigenvalues(gram).maxCoeff()));
}

inline double spectral3(const Eigen::Matrix3d& m) {
  return spectral(ChartMatrix(m));
}

inline double squared(double x) {
  return x * x;
}

class PoseChart {
 public:
  PoseChart(const control::Plan& plan, const control::Linkage& at, const Eigen::VectorXd& damping,
            const PoseDemand& demand)
      : plan_(plan),
        at_(at),
        spread_(damping.cwiseSqrt().cwiseInverse()),
        steps_(damping.size()),
        bending_(0.5 * plan.period_s * demand.bending_force) {
    const algebra::SymmetricEigen weight = algebra::symmetric_eigen(demand.weight);
    const Eigen::VectorXd roots = weight.values.cwiseMax(0.0).cwiseSqrt();
    S_ = roots.asDiagonal() * weight.vectors.transpose();
    stiffest_ = roots.maxCoeff() * kDenseMargin;
    for (Eigen::Index i = 0; i < steps_.size(); ++i)
      steps_[i] =
          plan.axes[at.first_axis + static_cast<std::size_t>(i)].max_velocity * plan.period_s;
    turn_.resize(at.coordinates, 3);
    for (Eigen::Index i = 0; i < turn_.rows(); ++i)
      for (Eigen::Index j = 0; j < 3; ++j)
        turn_(i, j) = at.turn[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)];
    scale_ = spectral(turn_) * kDenseMargin;
    for (const control::Serial& chain : plan.serials) {
      if (&plan.linkages[chain.linkage] != &at) continue;
      const auto end = chain.joint.begin() + chain.joints;
      const auto slides = std::count_if(chain.joint.begin(), end,
                                        [](const control::DhJoint& j) { return j.prismatic; });
      mixed_ = slides > 0 && slides < chain.joints;
    }
    for (const control::WorkspacePlan& box : plan.workspaces)
      if (box.device == at.device) box_ = box;
  }

  /// Is some of these contact coordinates in the workspace box?
  bool may_be_in_box(const std::array<Interval, 3>& x) const {
    if (!box_) return true;
    for (std::size_t i = 0; i < at_.coordinates; ++i)
      if (x[i].high < box_->min[i] || x[i].low > box_->max[i]) return false;
    return true;
  }

  /// Of a place of the tip in the device's frame.
  std::array<Interval, 3> contact_of(const std::array<Interval, 3>& tip) const {
    std::array<Interval, 3> x;
    for (std::size_t i = 0; i < at_.coordinates; ++i) {
      x[i] = at_.origin[i];
      for (std::size_t j = 0; j < 3; ++j) x[i] = x[i] + Interval(at_.turn[i][j]) * tip[j];
    }
    return x;
  }

  /// `jacobian`: coordinates x axes. Does no guard bite there?
  bool is_guarded(const std::array<double, 3>& x, const ChartMatrix& jacobian) const {
    std::array<Interval, 3> place;
    for (std::size_t i = 0; i < 3; ++i) place[i] = x[i];
    if (!may_be_in_box(place)) return false;
    if (std::isinf(at_.max_condition) || mixed_) return true;
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> rows = jacobian;
    return control::reach_of(at_, rows.data()) >= 1;
  }

  /// The singularity guard surely bites: singular values of J or of J^-1 (kappa is the same), each
  /// known to within `error` in the spectral norm.
  bool is_surely_singular(const ChartMatrix& known, double error) const {
    if (std::isinf(at_.max_condition) || mixed_ || at_.axes != at_.coordinates) return false;
    if (!std::isfinite(error)) return false;
    double least = 0, inverse = 0;
    for (const double s : algebra::singular_values(Eigen::MatrixXd(known))) {
      least += squared(std::max(0.0, s - error));
      inverse += 1 / squared(s + error);
    }
    return beyond_guard(std::sqrt(least * inverse));
  }
  /// A lower bound of kappa that is beyond what the guard lets pass without fading.
  bool beyond_guard(double kappa) const { return kappa > 0.5 * at_.max_condition * kDenseMargin; }

  const control::Plan& plan_;
  const control::Linkage& at_;
  ChartVector spread_;   ///< D_q^(-1/2)
  ChartVector steps_;    ///< rad or m: longest way of each joint in a period
  double bending_;       ///< N s: (T/2) F
  Eigen::MatrixXd S_;    ///< S'S = W, over the contact coordinates
  double stiffest_ = 0;  ///< |S|
  /// Joints that turn and joints that slide: the loop's guard weighs them by what their actuators can
  /// give (control/kinematics), so no pose is taken for one that it fades.
  bool mixed_ = false;
  Eigen::MatrixXd turn_;
  double scale_ = 1;  ///< |turn|
  std::optional<control::WorkspacePlan> box_;
};

}  // namespace hapticd::check
