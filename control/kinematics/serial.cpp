// Serial chain in standard Denavit-Hartenberg form. Joint j turns about (or slides along) z_{j-1}
// through o_{j-1}; link j hangs behind it. With p the tip:
//
//   dp/dq_j = z x (p - o)  revolute,  z  prismatic
//
// Holding efforts are dU/dq of the potential U = -sum m_k g . c_k over the links behind the joint;
// with their mass M and first moment S = sum m_k c_k:
//
//   tau_j = -z . ((S - M o) x g)  revolute,  -M z . g  prismatic
#include <Eigen/Geometry>
#include <cmath>

#include "control/kinematics/kinematics.h"

namespace hapticd::control {
namespace {

using Eigen::Vector3d;

struct LinkFrame {
  Vector3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1}, origin{0, 0, 0};
};

/// frames[0] is the base's, frames[j] that of link j.
using LinkFrames = std::array<LinkFrame, kMaxJoints + 1>;

/// Rz(theta) Tz(d) Tx(a) Rx(twist).
LinkFrame link_behind(const LinkFrame& at, const DhJoint& joint, double q) noexcept {
  const double angle = joint.prismatic ? joint.theta : joint.theta + q;
  const double slide = joint.prismatic ? joint.d + q : joint.d;
  const double c = std::cos(angle), s = std::sin(angle);
  const Vector3d x = c * at.x + s * at.y, y = c * at.y - s * at.x;
  return {.x = x,
          .y = joint.cos_twist * y + joint.sin_twist * at.z,
          .z = joint.cos_twist * at.z - joint.sin_twist * y,
          .origin = at.origin + slide * at.z + joint.a * x};
}

void chain_up(const Serial& chain, const double* q, LinkFrames& frames) noexcept {
  for (std::size_t j = 0; j < chain.joints; ++j)
    frames[j + 1] = link_behind(frames[j], chain.joint[j], q[j]);
}

}  // namespace

bool pose_of(const Serial& chain, const double* q, LinkagePose& pose) noexcept {
  LinkFrames frames;
  chain_up(chain, q, frames);
  const Vector3d& tip = frames[chain.joints].origin;
  if (!std::isfinite(tip.sum())) return false;
  for (std::size_t j = 0; j < chain.joints; ++j) {
    const Vector3d& axis = frames[j].z;
    const Vector3d column =
        chain.joint[j].prismatic ? axis : Vector3d(axis.cross(tip - frames[j].origin));
    for (std::size_t i = 0; i < 3; ++i) pose.jacobian[i][j] = column[static_cast<int>(i)];
  }
  pose.tip = {tip.x(), tip.y(), tip.z()};
  return true;
}

void holding_efforts(const Serial& chain, const double* q, const std::array<double, 3>& gravity,
                     double* effort) noexcept {
  const Vector3d g(gravity.data());
  LinkFrames frames;
  chain_up(chain, q, frames);
  double mass = 0;
  Vector3d moment = Vector3d::Zero();
  for (std::size_t j = chain.joints; j-- > 0;) {
    const DhJoint& joint = chain.joint[j];
    const LinkFrame &base = frames[j], &link = frames[j + 1];
    mass += joint.mass;
    moment += joint.mass * (link.origin + joint.center[0] * link.x + joint.center[1] * link.y +
                            joint.center[2] * link.z);
    effort[j] = joint.prismatic ? -mass * base.z.dot(g)
                                : -base.z.dot((moment - mass * base.origin).cross(g));
  }
}

}  // namespace hapticd::control
