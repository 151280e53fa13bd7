#include "config/contact_frame.h"

#include <algorithm>
#include <cmath>

#include "config/compilation.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// Entries of a rotation this near to 0 or 1 are meant to be that: rounding, not geometry.
constexpr double kRounding = 1e-12;
/// A quaternion this far from length 1 is a mistake, not a rounded number.
constexpr double kMaxLengthError = 0.01;

constexpr std::array<Vector3, 3> kUnit{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

double snapped(double entry) {
  const double whole = std::round(entry);
  return std::abs(entry - whole) < kRounding ? whole : entry;
}

/// Of a unit quaternion w, x, y, z.
Matrix3 rotation_of(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  Matrix3 rotation{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                    {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                    {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  for (Vector3& row : rotation) {
    for (double& entry : row) entry = snapped(entry);
  }
  return rotation;
}

Matrix3 rotation_of(Compilation& compilation, const Pose& pose, const std::string& path) {
  std::array<double, 4> q = pose.rotation_quaternion;
  double square = 0;
  for (const double part : q) square += part * part;
  const double length = std::sqrt(square);
  if (std::abs(length - 1) > kMaxLengthError) {
    compilation.refuse(path + ".rotation_quaternion",
                       "expected w, x, y, z of length 1, found length " + format_number(length) +
                           "; no rotation is [1, 0, 0, 0]");
    return kUnit;
  }
  for (double& part : q) part /= length;
  return rotation_of(q);
}

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
  frame.rotation = rotation_of(compilation, device.pose, device_path + ".pose");
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
