// The mass of a linkage as its joints feel it:
//
//   M(q) q'' = load(q, q') + efforts,  M = diag(I) + sum_ab w_ab J_a' J_b,
//   load = sum_a J_a' (g_a - sum_b w_ab bias_b)
//
// over the points a, b of mass_points.h: w_ab is the mass shared by two of them, g_a the weight at
// one. A uniform rod of mass m between points with velocities a, b has the kinetic energy
// (m/6) (a.a + a.b + b.b): w_aa = w_bb = m/3, w_ab = m/6; half its weight hangs at each end.
#pragma once
#include <span>

#include "sim/mass_points.h"

namespace hapticd::sim {

/// Of a linkage in one state of motion.
struct JointDynamics {
  MassPoints points;
  JointMatrix mass = JointMatrix::Identity();  ///< unused joints: 1 on the diagonal
  Joints load = Joints::Zero();                ///< of weight, and centrifugal and Coriolis
  double weight_J = 0;                         ///< potential energy
};

class JointMass {
 public:
  /// `hand_kg` moves with the tip but has no weight: the hand carries that itself.
  JointMass(const LinkageOptions& linkage, std::span<const AxisOptions> joints, double hand_kg);

  /// `at.points.point[0].at` says where to look for the tip. False, and `at` is not to be used, where
  /// no pose fits.
  bool dynamics(const Joints& q, const Joints& qd, JointDynamics& at) const noexcept;

 private:
  static constexpr int kPoints = 1 + kJointRows;

  Geometry geometry_;
  Joints inertia_;                                     ///< at the joints themselves
  Eigen::Matrix<double, kPoints, kPoints> shared_kg_;  ///< w_ab
  Eigen::Matrix<double, 3, kPoints> weight_N_;         ///< g_a
};

}  // namespace hapticd::sim
