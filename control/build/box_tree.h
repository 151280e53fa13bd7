// Makes trees of boxes (control/scene/box_tree.h).
#pragma once
#include <cstdint>
#include <limits>
#include <vector>

#include "control/core/vec3.h"
#include "control/scene/box_tree.h"

namespace hapticd::build {

struct Bounds {
  Vec3 min{};
  Vec3 max{};
};

/// Contains nothing; extend() makes it grow.
inline constexpr double kBoundless = std::numeric_limits<double>::infinity();
inline constexpr Bounds kNoBounds{{kBoundless, kBoundless, kBoundless},
                                  {-kBoundless, -kBoundless, -kBoundless}};
void extend(Bounds& bounds, const Vec3& point);

/// Storage of a tree; not movable while `view()` is in use.
struct BoxTreeData {
  std::vector<control::BoxNode> nodes;
  std::vector<std::uint32_t> items;
  control::BoxTree view() const noexcept { return {nodes, items}; }
};

/// A tree over finite boxes: item i has bounds[i]. At most `leaf` items a leaf. Depth stays below
/// control::kMaxTreeDepth for any input (median splits). O(n log n).
BoxTreeData make_box_tree(const std::vector<Bounds>& bounds, std::uint32_t leaf);

}  // namespace hapticd::build
