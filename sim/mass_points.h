// The points of a linkage that carry its mass: where they are, their Jacobians, and how they
// accelerate while the joints move on at constant velocity,
//
//   p'' = J(q) q'' + bias(q, q')
//
// [0] is the tip. A five-bar's [1] and [2] are its elbows, a chain's [k] the centre of its k-th
// link.
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>

#include "control/core/capacity.h"
#include "sim/options.h"

namespace hapticd::sim {

// Always kMaxJoints long, so that their size is known to the compiler; joints that a linkage does
// not have are 0.
constexpr int kJointRows = static_cast<int>(kMaxJoints);
using Joints = Eigen::Matrix<double, kJointRows, 1>;
using JointMatrix = Eigen::Matrix<double, kJointRows, kJointRows>;
using PointJacobian = Eigen::Matrix<double, 3, kJointRows>;

using Geometry = decltype(LinkageOptions::geometry);

struct MassPoint {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();    ///< m, device frame
  PointJacobian jacobian = PointJacobian::Zero();  ///< m per rad, or 1
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  ///< m/s^2
};

struct MassPoints {
  std::array<MassPoint, 1 + kMaxJoints> point;
  std::size_t count = 1;
};

/// Joints that the geometry has; 0: as many as there are axes.
std::size_t joint_count(const Geometry& geometry) noexcept;

/// The points at q, moving at qd. points[0].at says where to look for the tip (delta). False, and
/// `points` are not to be used, where no pose fits.
bool move_points(const Geometry& geometry, const Joints& q, const Joints& qd,
                 MassPoints& points) noexcept;

}  // namespace hapticd::sim
