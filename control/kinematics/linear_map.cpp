#include <cmath>

#include "control/kinematics/kinematics.h"

namespace hapticd::control {

// A column of zeros is an axis that the device does not have: its q is not read.
bool pose_of(const LinearMap& map, const double* q, LinkagePose& pose) noexcept {
  std::array<double, 3> tip{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < kMaxJoints; ++j) {
      if (map.columns[i][j] != 0) tip[i] += map.columns[i][j] * q[j];
    }
  }
  if (!std::isfinite(tip[0] + tip[1] + tip[2])) return false;
  pose = {.tip = tip, .jacobian = map.columns};
  return true;
}

}  // namespace hapticd::control
