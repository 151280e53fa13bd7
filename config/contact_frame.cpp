#include "config/contact_frame.h"

#include <algorithm>
#include <cmath>

#include "config/compilation.h"
#include "config/geometry.h"

namespace hapticd::config {
namespace {

/// Entries of a rotation this near to 0 are meant to be that: rounding, not geometry.
constexpr double kRounding = 1e-12;

constexpr std::array<Vector3, 3> kUnit{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

std::vector<Vector3> motions_of(const Cartesian& cartesian) {
  std::vector<Vector3> motions;
  for (const Direction direction : cartesian.directions)
    motions.push_back(kUnit[static_cast<std::size_t>(direction)]);
  return motions;
}

std::vector<Vector3> motions_of(const FiveBar&) {
  return {kUnit[0], kUnit[1]};
}

std::vector<Vector3> motions_of(const Delta&) {
  return {kUnit.begin(), kUnit.end()};
}

/// A chain of turning joints whose axes are all parallel stays in a plane. The last twist turns the
/// tip only.
std::vector<Vector3> motions_of(const Serial& serial) {
  bool planar = true;
  for (std::size_t i = 0; i < serial.joints.size(); ++i) {
    const SerialJoint& joint = serial.joints[i];
    const bool last = i + 1 == serial.joints.size();
    const bool parallel = last || std::abs(std::sin(joint.alpha_rad)) < kRounding;
    planar = planar && !joint.prismatic && parallel;
  }
  if (planar) return {kUnit[0], kUnit[1]};
  return {kUnit.begin(), kUnit.end()};
}

double dot(const Vector3& a, const Vector3& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

}  // namespace

Vector3 ContactFrame::turn(std::size_t coordinate) const {
  Vector3 row = rotation[directions[coordinate]];
  for (double& entry : row) entry *= scale;
  return row;
}

Vector3 ContactFrame::into_device(const Vector3& world) const {
  Vector3 turned{};
  for (std::size_t i = 0; i < turned.size(); ++i) {
    for (std::size_t j = 0; j < world.size(); ++j) turned[i] += rotation[j][i] * world[j];
  }
  return turned;
}

ContactFrame contact_frame(Compilation& compilation, const Device& device,
                           const std::string& device_path) {
  ContactFrame frame;
  frame.rotation = rotation_of(unit_quaternion(compilation, device.pose.rotation_quaternion,
                                               device_path + ".pose.rotation_quaternion"));
  frame.position = device.pose.position_m;
  frame.scale = device.workspace_scale;
  frame.motions = std::visit([](const auto& kind) { return motions_of(kind); }, device.kinematics);
  for (std::size_t world = 0; world < frame.rotation.size(); ++world) {
    const auto moves = [&](const Vector3& motion) {
      return std::abs(dot(frame.rotation[world], motion)) > kRounding;
    };
    if (std::any_of(frame.motions.begin(), frame.motions.end(), moves))
      frame.directions.push_back(world);
  }
  return frame;
}

}  // namespace hapticd::config
