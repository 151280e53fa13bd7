#include "control/design/check/pose_serial.h"

namespace hapticd::check {

double SerialCells::farthest(std::size_t j, std::size_t last,
                             const std::array<double, kMaxJoints>& slide) const {
  double length = std::abs(chain_.joint[j].a);
  for (std::size_t k = j + 1; k <= last; ++k) {
    const control::DhJoint& joint = chain_.joint[k];
    length += std::hypot(joint.a, joint.prismatic ? slide[k] : joint.d);
  }
  return length;
}

ChartMatrix SerialCells::curvature(const std::array<double, kMaxJoints>& columns) const {
  const auto n = static_cast<Eigen::Index>(chain_.joints);
  ChartMatrix bound = ChartMatrix::Zero(n, n);
  for (std::size_t j = 0; j < chain_.joints; ++j) {
    for (std::size_t i = 0; i <= j; ++i) {
      if (chain_.joint[i].prismatic) continue;
      const auto row = static_cast<Eigen::Index>(i), column = static_cast<Eigen::Index>(j);
      bound(row, column) = bound(column, row) = chain_.joint[j].prismatic ? 1.0 : columns[j];
    }
  }
  return bound;
}

/// Frobenius norm of a bound of |d2U/dq2|, U = -sum m_k g . c_k.
double SerialCells::load(const std::array<double, kMaxJoints>& slide) const {
  const auto& g = chain_.gravity;
  const double gravity = std::hypot(g[0], g[1], g[2]);
  ChartMatrix sum = curvature({});
  sum.setZero();
  for (std::size_t k = 0; k < chain_.joints && gravity > 0; ++k) {
    const control::DhJoint& link = chain_.joint[k];
    const double centre = std::hypot(link.center[0], link.center[1], link.center[2]);
    std::array<double, kMaxJoints> arms{};
    for (std::size_t j = 0; j <= k; ++j) arms[j] = farthest(j, k, slide) + centre;
    const auto moved = static_cast<Eigen::Index>(k + 1);
    sum.topLeftCorner(moved, moved) +=
        link.mass * gravity * curvature(arms).topLeftCorner(moved, moved);
  }
  return sum.norm();
}

JointCell SerialCells::look(const PoseChart& chart, const Cell& cell) const {
  JointCell seen;
  std::array<double, kMaxJoints> middle{}, slide{}, columns{};
  const auto n = static_cast<Eigen::Index>(chain_.joints);
  ChartVector half(n);
  for (std::size_t i = 0; i < chain_.joints; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    middle[i] = cell.middle(i);
    half[row] = cell.half(i);
    slide[i] = std::abs(chain_.joint[i].d + middle[i]) + half[row] + chart.steps_[row];
  }
  control::LinkagePose pose;
  if (!control::pose_of(chain_, middle.data(), pose)) return seen;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxJoints> own(3, n);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < chain_.joints; ++j)
      own(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = pose.jacobian[i][j];
  for (std::size_t j = 0; j < chain_.joints; ++j)
    columns[j] = farthest(j, chain_.joints - 1, slide);
  const ChartVector change = curvature(columns) * (half + chart.steps_);
  for (std::size_t j = 0; j < chain_.joints; ++j) {
    const auto row = static_cast<Eigen::Index>(j);
    columns[j] = std::min(columns[j], own.col(row).norm() + change[row]);
  }
  seen.has_middle = true;
  seen.jacobian = chart.turn_ * own;
  seen.curvature = chart.scale_ * curvature(columns);
  seen.load = load(slide);
  const ChartVector moved = seen.curvature * half;
  for (std::size_t i = 0; i < chart.at_.coordinates; ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    seen.x[i] = chart.at_.origin[i];
    for (std::size_t j = 0; j < 3; ++j) seen.x[i] += chart.at_.turn[i][j] * pose.tip[j];
    const double reach =
        kDenseMargin * (seen.jacobian.row(row).cwiseAbs().transpose() + moved).dot(half);
    seen.places[i] = {seen.x[i] - reach - 1e-12, seen.x[i] + reach + 1e-12};
  }
  return seen;
}

}  // namespace hapticd::check
