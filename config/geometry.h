// Directions and rotations of a config as the plan wants them.
#pragma once
#include <array>
#include <optional>
#include <string>

#include "config/contact_frame.h"
#include "control/core/vec3.h"

namespace hapticd::config {

class Compilation;

Vec3 to_vec3(const Vector3& v);

/// Of length 1. Reports one of length 0, a `what`, at `path`.
std::optional<Vec3> unit_vector(Compilation& compilation, const Vector3& direction,
                                const std::string& path, const std::string& what);

/// w, x, y, z, of length 1 to the last digit. Reports one that is not nearly so long, and gives no
/// rotation then.
std::array<double, 4> unit_quaternion(Compilation& compilation, std::array<double, 4> quaternion,
                                      const std::string& path);

/// Of a unit quaternion; what is 0 or 1 but for rounding is exactly that.
Matrix3 rotation_of(const std::array<double, 4>& quaternion);

Mat3 to_mat3(const Matrix3& rows);

}  // namespace hapticd::config
