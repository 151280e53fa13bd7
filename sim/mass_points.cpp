#include "sim/mass_points.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <variant>

namespace hapticd::sim {
namespace {

using Eigen::Vector3d;

template <class Kind>
bool place_tip(const Kind& kind, const Joints& q, MassPoint& tip) noexcept {
  control::LinkagePose pose;
  Vector3d::Map(pose.tip.data()) = tip.at;
  if (!pose_of(kind, q.data(), pose)) return false;
  tip.at = Vector3d::Map(pose.tip.data());
  for (int i = 0; i < 3; ++i)
    tip.jacobian.row(i) = Joints::Map(pose.jacobian[static_cast<std::size_t>(i)].data());
  return true;
}

// What hangs between base and tip.
void place_links(const control::LinearMap&, const Joints&, MassPoints& points) noexcept {
  points.count = 1;
}
void place_links(const control::Delta&, const Joints&, MassPoints& points) noexcept {
  points.count = 1;
}

void place_links(const control::FiveBar& bars, const Joints& q, MassPoints& points) noexcept {
  points.count = 3;
  for (const int i : {0, 1}) {
    MassPoint& elbow = points.point[static_cast<std::size_t>(1 + i)];
    const double x = bars.link_m * std::cos(q[i]), y = bars.link_m * std::sin(q[i]);
    elbow.at = {x + (i == 0 ? -0.5 : 0.5) * bars.base_m, y, 0};
    elbow.jacobian.col(i) = Vector3d(-y, x, 0);
  }
}

// Frame of link k: frame of link k-1, then Rz(theta) Tz(d) Tx(a) Rx(twist).
void place_links(const control::Serial& chain, const Joints& q, MassPoints& points) noexcept {
  points.count = 1 + chain.joints;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  Vector3d origin = Vector3d::Zero();
  std::array<Vector3d, kMaxJoints> axis, pivot;
  for (std::size_t k = 0; k < chain.joints; ++k) {
    const control::DhJoint& joint = chain.joint[k];
    axis[k] = turn.col(2);
    pivot[k] = origin;
    const double angle = joint.theta + (joint.prismatic ? 0 : q[static_cast<int>(k)]);
    const double slide = joint.d + (joint.prismatic ? q[static_cast<int>(k)] : 0);
    const Vector3d x = std::cos(angle) * turn.col(0) + std::sin(angle) * turn.col(1);
    const Vector3d y = axis[k].cross(x);
    turn << x, joint.cos_twist * y + joint.sin_twist * axis[k],
        joint.cos_twist * axis[k] - joint.sin_twist * y;
    origin += slide * axis[k] + joint.a * x;
    MassPoint& link = points.point[1 + k];
    link.at = origin + turn * Vector3d::Map(joint.center.data());
    for (std::size_t j = 0; j <= k; ++j) {
      const Vector3d arm = link.at - pivot[j];
      link.jacobian.col(static_cast<int>(j)) =
          chain.joint[j].prismatic ? axis[j] : axis[j].cross(arm);
    }
  }
}

template <class Kind>
bool place(const Kind& kind, const Joints& q, MassPoints& points) noexcept {
  if (!place_tip(kind, q, points.point[0])) return false;
  place_links(kind, q, points);
  return true;
}

// bias = d/ds [J(q + s qd) qd] at s = 0, by the central difference of fourth order
//
//   [8 (v(h) - v(-h)) - (v(2h) - v(-2h))] / 12 h
//
// over h |qd| = 5e-4 rad or m: what it leaves out is h^4/30 of the fifth derivative of the motion
// and the rounding is 2^-53/h, each some 1e-13 of the bias (1e-11 for a slide of centimetres).
template <class Kind>
bool bias(const Kind& kind, const Joints& q, const Joints& qd, MassPoints& points) noexcept {
  constexpr double kStep = 5e-4;
  for (std::size_t i = 0; i < points.count; ++i) points.point[i].bias.setZero();
  const double speed = qd.cwiseAbs().maxCoeff();
  if (speed == 0) return true;
  const double h = kStep / speed;
  for (const int step : {-2, -1, 1, 2}) {
    MassPoints near = points;
    if (!place(kind, q + step * h * qd, near)) return false;
    const double weight = (std::abs(step) == 1 ? 8 : -1) * (step > 0 ? 1 : -1) / (12 * h);
    for (std::size_t i = 0; i < points.count; ++i)
      points.point[i].bias += weight * (near.point[i].jacobian * qd);
  }
  return true;
}

// The outer links r_i = P - E_i keep their length: r_i . (P'' - E_i'') = -|P' - E_i'|^2, with
// E_i'' = -(E_i - base_i) q_i'^2 at constant q'.
bool bias(const control::FiveBar& bars, const Joints&, const Joints& qd,
          MassPoints& points) noexcept {
  MassPoint& tip = points.point[0];
  Eigen::Matrix2d outer;
  Eigen::Vector2d right;
  for (const int i : {0, 1}) {
    MassPoint& elbow = points.point[static_cast<std::size_t>(1 + i)];
    const Vector3d base((i == 0 ? -0.5 : 0.5) * bars.base_m, 0, 0);
    elbow.bias = -qd[i] * qd[i] * (elbow.at - base);
    const Vector3d r = tip.at - elbow.at;
    outer.row(i) = r.head<2>();
    right[i] = r.dot(elbow.bias) - ((tip.jacobian - elbow.jacobian) * qd).squaredNorm();
  }
  tip.bias << outer.inverse() * right, 0;
  return true;
}

struct JointCount {
  std::size_t operator()(const control::LinearMap&) const noexcept { return 0; }
  std::size_t operator()(const control::FiveBar&) const noexcept { return 2; }
  std::size_t operator()(const control::Delta&) const noexcept { return 3; }
  std::size_t operator()(const control::Serial& chain) const noexcept { return chain.joints; }
};

}  // namespace

std::size_t joint_count(const Geometry& geometry) noexcept {
  return std::visit(JointCount{}, geometry);
}

bool move_points(const Geometry& geometry, const Joints& q, const Joints& qd,
                 MassPoints& points) noexcept {
  return std::visit(
      [&](const auto& kind) { return place(kind, q, points) && bias(kind, q, qd, points); },
      geometry);
}

}  // namespace hapticd::sim
