// Devices with joints, for tests: the geometries, and one of them in a plan of its own.
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "control/build/program.h"

namespace hapticd::test {

using JointAngles = std::array<double, kMaxJoints>;

inline nlohmann::json kinematics_data(const std::string& name) {
  return nlohmann::json::parse(
      std::ifstream(HAPTICD_SOURCE_DIR "/tests/data/kinematics/" + name + ".json"));
}

/// Of the observer paper's device.
inline control::FiveBar five_bar() {
  return {.link_m = 0.2, .base_m = 0.1};
}

/// Novint Falcon.
inline control::Delta falcon() {
  const auto leg = [](double degrees) {
    return std::array{std::cos(degrees * M_PI / 180), std::sin(degrees * M_PI / 180)};
  };
  return {.a = 0.060,
          .b = 0.1025,
          .c = 0.01443,
          .d = 0.01125,
          .e = 0.01125,
          .f = -0.025,
          .r = 0.0400,
          .s = -0.02309,
          .leg = {leg(105), leg(-15), leg(-135)},
          .home = {0, 0, 0.11}};
}

inline control::DhJoint revolute(double theta, double d, double a, double twist) {
  return {
      .theta = theta, .d = d, .a = a, .cos_twist = std::cos(twist), .sin_twist = std::sin(twist)};
}
inline control::DhJoint prismatic(double theta, double d, double a, double twist) {
  control::DhJoint joint = revolute(theta, d, a, twist);
  joint.prismatic = true;
  return joint;
}

/// Six revolute joints with no axis parallel to a coordinate's, each link with a mass off its axis.
inline control::Serial six_joints() {
  control::Serial chain{.joints = 6,
                        .joint = {revolute(0.1, 0.3, 0.05, -1.5), revolute(-0.2, 0.02, 0.4, 0.1),
                                  revolute(0.3, 0.15, -0.02, 1.4), revolute(0, 0.4, 0.01, -1.6),
                                  revolute(0.5, -0.01, 0.03, 1.5), revolute(0, 0.1, 0.02, 0.2)}};
  for (std::size_t j = 0; j < 6; ++j) {
    chain.joint[j].mass = 1.0 / static_cast<double>(j + 1);
    chain.joint[j].center = {-0.1, 0.02 * static_cast<double>(j), 0.03};
  }
  return chain;
}

/// Turning, sliding, turning: what has two units in one Jacobian.
inline control::Serial mixed_joints() {
  control::Serial chain{.joints = 3,
                        .joint = {revolute(0, 0.2, 0.1, 0.7), prismatic(0.3, 0.1, 0.05, -1.1),
                                  revolute(0.2, 0.05, 0.25, 0)}};
  for (control::DhJoint& joint : chain.joint) joint.mass = 0.5, joint.center = {0.01, -0.02, 0.03};
  return chain;
}

/// Where a linkage stands and how much of it the contact has.
struct Mount {
  std::uint16_t axes = 0;
  std::uint16_t coordinates = 0;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< scale * rotation
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double max_condition = 20;
};

/// One linkage in a plan of its own, behind a Cartesian device of one axis (so that no index is 0 by
/// luck). Its axes are homed.
class LinkageRig {
 public:
  template <class Kind>
  LinkageRig(Kind kind, const Mount& mount) : program(spec(kind, mount)), axes(mount.axes) {
    for (control::AxisState& axis : state().axes) axis.seeded = axis.homed = true;
  }

  /// Forward kinematics with joints at q, moving at qd.
  control::Findings forward(const double* q, const double* qd = nullptr) {
    for (std::size_t j = 0; j < axes; ++j) {
      state().q[1 + j] = q[j];
      state().qd[1 + j] = qd ? qd[j] : 0;
    }
    control::Findings findings;
    control::forward(plan(), state(), findings);
    return findings;
  }
  double reach() { return state().reach[1]; }
  const control::Plan& plan() const { return program.plan(); }
  control::State& state() { return program.state(); }

  build::Program program;
  std::size_t axes;

 private:
  static void add(build::ProgramSpec& s, const control::LinearMap& k) { s.linear_maps = {k}; }
  static void add(build::ProgramSpec& s, const control::FiveBar& k) { s.five_bars = {k}; }
  static void add(build::ProgramSpec& s, const control::Delta& k) { s.deltas = {k}; }
  static void add(build::ProgramSpec& s, const control::Serial& k) { s.serials = {k}; }

  template <class Kind>
  static build::ProgramSpec spec(const Kind& kind, const Mount& mount) {
    build::ProgramSpec s;
    s.axes.assign(1u + mount.axes, {.max_effort = 1});
    s.devices = {{.axes = 1, .coordinates = 1},
                 {.first_axis = 1,
                  .axes = mount.axes,
                  .first_coordinate = 1,
                  .coordinates = mount.coordinates}};
    control::Linkage linkage{.device = 1,
                             .first_axis = 1,
                             .axes = mount.axes,
                             .first_coordinate = 1,
                             .coordinates = mount.coordinates,
                             .max_condition = mount.max_condition};
    for (std::size_t i = 0; i < 3; ++i) {
      linkage.origin[i] = mount.origin[static_cast<int>(i)];
      for (std::size_t k = 0; k < 3; ++k)
        linkage.turn[i][k] = mount.turn(static_cast<int>(i), static_cast<int>(k));
    }
    s.linkages = {linkage};
    add(s, kind);
    return s;
  }
};

/// dp/dq by central differences of pose_of, started from the pose at q.
template <class Kind>
Eigen::Matrix3Xd numerical_jacobian(const Kind& kind, JointAngles q, std::size_t axes,
                                    const control::LinkagePose& at, double step = 1e-5) {
  Eigen::Matrix3Xd jacobian(3, axes);
  for (std::size_t j = 0; j < axes; ++j) {
    control::LinkagePose ahead = at, behind = at;
    const double middle = q[j];
    q[j] = middle + step;
    const bool fits_ahead = pose_of(kind, q.data(), ahead);
    q[j] = middle - step;
    const bool fits_behind = pose_of(kind, q.data(), behind);
    q[j] = middle;
    for (int i = 0; i < 3; ++i) {
      const auto row = static_cast<std::size_t>(i);
      jacobian(i, static_cast<int>(j)) =
          fits_ahead && fits_behind ? (ahead.tip[row] - behind.tip[row]) / (2 * step) : NAN;
    }
  }
  return jacobian;
}

inline Eigen::Matrix3Xd jacobian_of(const control::LinkagePose& pose, std::size_t axes) {
  Eigen::Matrix3Xd jacobian(3, axes);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < axes; ++j)
      jacobian(static_cast<int>(i), static_cast<int>(j)) = pose.jacobian[i][j];
  }
  return jacobian;
}

inline Eigen::Vector3d tip_of(const control::LinkagePose& pose) {
  return Eigen::Vector3d(pose.tip.data());
}

}  // namespace hapticd::test
