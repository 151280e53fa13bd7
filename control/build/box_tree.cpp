#include "control/build/box_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hapticd::build {
namespace {

float rounded_down(double value) {
  const auto near = static_cast<float>(value);
  return static_cast<double>(near) > value ? std::nextafterf(near, -HUGE_VALF) : near;
}

/// Splits at the median of the centres along the direction in which they spread most.
class TreeMaker {
 public:
  TreeMaker(const std::vector<Bounds>& bounds, std::uint32_t leaf)
      : bounds_(bounds), leaf_(std::max(leaf, 1U)) {
    tree_.items.resize(bounds.size());
    std::iota(tree_.items.begin(), tree_.items.end(), 0U);
    const std::size_t leaves = bounds.size() / leaf_ + 1;
    tree_.nodes.reserve(4 * leaves + 2);
  }

  BoxTreeData make() {
    if (bounds_.empty()) return {};
    // The second node is not used: pairs of children then begin at even numbers, in a cache line.
    tree_.nodes.resize(2);
    fill(0, 0, static_cast<std::uint32_t>(bounds_.size()));
    return std::move(tree_);
  }

 private:
  void fill(std::uint32_t index, std::uint32_t first, std::uint32_t count) {
    set_box(tree_.nodes[index], first, count);
    if (count <= leaf_) {
      tree_.nodes[index].first = first;
      tree_.nodes[index].count = count;
      return;
    }
    const std::uint32_t left = count / 2;
    split(first, left, count);
    const auto child = static_cast<std::uint32_t>(tree_.nodes.size());
    tree_.nodes.resize(tree_.nodes.size() + 2);
    tree_.nodes[index].first = child;
    fill(child, first, left);
    fill(child + 1, first + left, count - left);
  }

  Vec3 doubled_centre(std::uint32_t item) const { return bounds_[item].min + bounds_[item].max; }

  void split(std::uint32_t first, std::uint32_t left, std::uint32_t count) {
    const auto begin = tree_.items.begin() + first;
    Bounds centres = kNoBounds;
    for (auto item = begin; item != begin + count; ++item) extend(centres, doubled_centre(*item));
    const Vec3 spread = centres.max - centres.min;
    const std::size_t axis = spread.x >= spread.y && spread.x >= spread.z ? 0
                             : spread.y >= spread.z                       ? 1
                                                                          : 2;
    std::nth_element(begin, begin + left, begin + count, [&](std::uint32_t a, std::uint32_t b) {
      return doubled_centre(a)[axis] < doubled_centre(b)[axis];
    });
  }

  void set_box(control::BoxNode& node, std::uint32_t first, std::uint32_t count) const {
    Bounds all = kNoBounds;
    for (std::uint32_t i = first; i < first + count; ++i) {
      extend(all, bounds_[tree_.items[i]].min);
      extend(all, bounds_[tree_.items[i]].max);
    }
    for (std::size_t i = 0; i < 3; ++i) {
      node.min[i] = rounded_down(all.min[i]);
      node.max[i] = -rounded_down(-all.max[i]);
    }
  }

  const std::vector<Bounds>& bounds_;
  std::uint32_t leaf_;
  BoxTreeData tree_;
};

}  // namespace

void extend(Bounds& bounds, const Vec3& point) {
  for (std::size_t i = 0; i < 3; ++i) {
    bounds.min[i] = std::min(bounds.min[i], point[i]);
    bounds.max[i] = std::max(bounds.max[i], point[i]);
  }
}

BoxTreeData make_box_tree(const std::vector<Bounds>& bounds, std::uint32_t leaf) {
  return TreeMaker(bounds, leaf).make();
}

}  // namespace hapticd::build
