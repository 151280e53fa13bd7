#include "sim/joint_mass.h"

#include <variant>

namespace hapticd::sim {

JointMass::JointMass(const LinkageOptions& linkage, std::span<const AxisOptions> joints,
                     double hand_kg)
    : geometry_(linkage.geometry), inertia_(Joints::Ones()) {
  for (std::size_t i = 0; i < joints.size(); ++i) inertia_[static_cast<int>(i)] = joints[i].mass_kg;
  Eigen::Matrix<double, kPoints, 1> hanging_kg = Eigen::Matrix<double, kPoints, 1>::Zero();
  shared_kg_.setZero();
  shared_kg_(0, 0) = linkage.tip_kg + hand_kg;
  hanging_kg[0] = linkage.tip_kg;
  if (std::holds_alternative<control::FiveBar>(geometry_)) {
    const double inner = linkage.inner_link_kg, outer = linkage.outer_link_kg;
    for (const int elbow : {1, 2}) {
      shared_kg_(0, 0) += outer / 3;
      shared_kg_(elbow, elbow) = (inner + outer) / 3;
      shared_kg_(0, elbow) = shared_kg_(elbow, 0) = outer / 6;
      hanging_kg[0] += outer / 2;
      hanging_kg[elbow] = (inner + outer) / 2;
    }
  }
  if (const auto* chain = std::get_if<control::Serial>(&geometry_)) {
    for (int k = 1; k <= static_cast<int>(chain->joints); ++k)
      shared_kg_(k, k) = hanging_kg[k] = chain->joint[static_cast<std::size_t>(k - 1)].mass;
  }
  weight_N_ = Eigen::Vector3d::Map(linkage.gravity.data()) * hanging_kg.transpose();
}

bool JointMass::dynamics(const Joints& q, const Joints& qd, JointDynamics& at) const noexcept {
  if (!move_points(geometry_, q, qd, at.points)) return false;
  at.mass = inertia_.asDiagonal();
  at.load.setZero();
  at.weight_J = 0;
  for (std::size_t a = 0; a < at.points.count; ++a) {
    const MassPoint& point = at.points.point[a];
    PointJacobian moved = PointJacobian::Zero();
    Eigen::Vector3d force = weight_N_.col(static_cast<int>(a));
    at.weight_J -= force.dot(point.at);
    for (std::size_t b = 0; b < at.points.count; ++b) {
      const double shared_kg = shared_kg_(static_cast<int>(a), static_cast<int>(b));
      if (shared_kg == 0) continue;
      moved += shared_kg * at.points.point[b].jacobian;
      force -= shared_kg * at.points.point[b].bias;
    }
    at.mass.noalias() += point.jacobian.transpose() * moved;
    at.load.noalias() += point.jacobian.transpose() * force;
  }
  return true;
}

}  // namespace hapticd::sim
