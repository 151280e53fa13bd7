#include "config/geometry.h"

#include <cmath>

#include "config/compilation.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// Entries of a rotation this near to 0 or 1 are meant to be that: rounding, not geometry.
constexpr double kSnap = 1e-12;
/// A quaternion this far from length 1 is a mistake, not a rounded number.
constexpr double kMaxLengthError = 0.01;
/// A direction as short as this has none.
constexpr double kLeastLength = 1e-9;

double snapped(double entry) {
  const double whole = std::round(entry);
  return std::abs(entry - whole) < kSnap ? whole : entry;
}

}  // namespace

Vec3 to_vec3(const Vector3& v) {
  return {v[0], v[1], v[2]};
}

std::optional<Vec3> unit_vector(Compilation& compilation, const Vector3& direction,
                                const std::string& path, const std::string& what) {
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!(length > kLeastLength)) {
    compilation.refuse(
        path, what + " of length 0 points nowhere; one that does is, for example, [1, 0, 0]");
    return {};
  }
  return Vec3{direction[0] / length, direction[1] / length, direction[2] / length};
}

std::array<double, 4> unit_quaternion(Compilation& compilation, std::array<double, 4> quaternion,
                                      const std::string& path) {
  double square = 0;
  for (const double part : quaternion) square += part * part;
  const double length = std::sqrt(square);
  if (std::abs(length - 1) > kMaxLengthError) {
    compilation.refuse(path, "expected w, x, y, z of length 1, found length " +
                                 format_number(length) + "; no rotation is [1, 0, 0, 0]");
    return {1, 0, 0, 0};
  }
  for (double& part : quaternion) part /= length;
  return quaternion;
}

Matrix3 rotation_of(const std::array<double, 4>& quaternion) {
  const auto [w, x, y, z] = quaternion;
  Matrix3 rotation{{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                    {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                    {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
  for (Vector3& row : rotation) {
    for (double& entry : row) entry = snapped(entry);
  }
  return rotation;
}

Mat3 to_mat3(const Matrix3& rows) {
  return {{to_vec3(rows[0]), to_vec3(rows[1]), to_vec3(rows[2])}};
}

}  // namespace hapticd::config
