// How a device stands in the world, and which coordinates its contact has: the world directions
// that the device can move in, in the order x, y, z.
//
//   x_world = position + scale R x_device,  force in the device = scale R' (force in the world)
//
// so work is the same on both sides. Limits of force are meant at the hand: in the world's scale
// they are divided by `scale`.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include "config/schema_device.h"

namespace hapticd::config {

struct DevicePlace;
class Compilation;

using Vector3 = std::array<double, 3>;
using Matrix3 = std::array<Vector3, 3>;  ///< by rows

struct ContactFrame {
  Matrix3 rotation{};  ///< device -> world
  Vector3 position{};  ///< m, world, of the device's origin
  double scale = 1;
  std::vector<Vector3> motions;         ///< device frame, unit vectors: what the tip can do
  std::vector<std::size_t> directions;  ///< of coordinate i: 0 x, 1 y, 2 z

  /// Row i of scale R, for coordinate i.
  Vector3 turn(std::size_t coordinate) const;
  /// A vector of the world in the device's frame: R' v.
  Vector3 into_device(const Vector3& world) const;
};

/// Reports a quaternion that is none.
ContactFrame contact_frame(Compilation& compilation, const Device& device,
                           const std::string& device_path);

}  // namespace hapticd::config
