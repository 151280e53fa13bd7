// The intersection of a few half-spaces: where a ball may be that several faces hold at once.
#pragma once
#include <array>
#include <cstddef>

#include "control/core/vec3.h"

namespace hapticd::control {

/// Free where normal.x >= offset.
struct Cut {
  Vec3 normal{};      ///< unit
  double offset = 0;  ///< m
};

/// Up to four: three that hold a point and one more.
struct Cuts {
  std::array<Cut, 4> cut{};
  std::size_t count = 0;
};

/// Moves `to` to the point of the intersection nearest to `p`. Every choice of one, two or three
/// planes is tried; of the points that fulfil all cuts the nearest is the answer. False, `to` as it
/// was: the intersection is empty, or a needle too sharp to be computed.
bool project(const Cuts& cuts, const Vec3& p, Vec3& to) noexcept;

/// Leaves out the cuts that `at` does not lie on, and of four the oldest.
void keep_active(Cuts& cuts, const Vec3& at) noexcept;

}  // namespace hapticd::control
