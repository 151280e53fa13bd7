// A tree of boxes: finds what is near a point among many things in time that grows with the
// logarithm of their number. Made by build/box_tree.h; meshes keep their triangles in one, the
// broad phase its objects.
//
// Node i: `count` > 0: a leaf with items[first .. first + count); else its children are `first` and
// `first + 1`, side by side, because a search looks at both. Boxes are floats, rounded outwards.
#pragma once
#include <array>
#include <cstdint>
#include <span>

#include "control/core/vec3.h"

namespace hapticd::control {

struct alignas(32) BoxNode {
  std::array<float, 3> min{};
  std::array<float, 3> max{};
  std::uint32_t first = 0;
  std::uint32_t count = 0;
};
static_assert(sizeof(BoxNode) == 32);

/// No deeper than this: a traversal's stack has that many entries.
inline constexpr std::size_t kMaxTreeDepth = 64;

struct BoxTree {
  std::span<const BoxNode> nodes;  ///< empty: nothing in it; else nodes[0] is the root
  std::span<const std::uint32_t> items;
};

/// Squared distance [m^2] from a point to a node's box; 0 inside.
inline double squared_distance(const BoxNode& node, const Vec3& p) noexcept {
  const auto outside = [](float min, float max, double at) {
    const double below = static_cast<double>(min) - at;
    const double above = at - static_cast<double>(max);
    const double out = below > above ? below : above;
    return out > 0 ? out : 0.0;
  };
  return squared_norm(Vec3{outside(node.min[0], node.max[0], p.x),
                           outside(node.min[1], node.max[1], p.y),
                           outside(node.min[2], node.max[2], p.z)});
}

/// Calls visit(item) for every item whose leaf's box comes within `reach` [m] of `p`.
template <class Visit>
void visit_near(const BoxTree& tree, const Vec3& p, double reach, Visit&& visit) noexcept {
  if (tree.nodes.empty()) return;
  std::array<std::uint32_t, kMaxTreeDepth> stack;
  std::size_t top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const BoxNode& node = tree.nodes[stack[--top]];
    if (squared_distance(node, p) > reach * reach) continue;
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) visit(tree.items[node.first + i]);
    } else {
      stack[top++] = node.first + 1;
      stack[top++] = node.first;
    }
  }
}

}  // namespace hapticd::control
