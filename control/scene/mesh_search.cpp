// Searches over the whole mesh, by its tree: the nearest point, the first crossing.
#include <limits>

#include "control/scene/mesh_point.h"

namespace hapticd::control {
namespace {

/// Boxes still to be looked at, with a lower bound of what they hold.
class BoxStack {
 public:
  void push(std::uint32_t node, double bound) noexcept { entries_[size_++] = {node, bound}; }
  /// The last one whose bound is below `limit`; false: there is none.
  bool pop_below(double limit, std::uint32_t& node) noexcept {
    while (size_ > 0) {
      const Entry& entry = entries_[--size_];
      if (!(entry.bound < limit)) continue;
      node = entry.node;
      return true;
    }
    return false;
  }

 private:
  struct Entry {
    std::uint32_t node;
    double bound;
  };
  std::array<Entry, 2 * kMaxTreeDepth> entries_;
  std::size_t size_ = 0;
};

/// The near child last, so that it is popped first.
void push_children(BoxStack& stack, std::uint32_t first, double left, double right) noexcept {
  const bool left_first = left < right;
  stack.push(left_first ? first + 1 : first, left_first ? right : left);
  stack.push(left_first ? first : first + 1, left_first ? left : right);
}

/// A segment from -> from + way, as the slab test wants it.
struct Segment {
  Vec3 from{};
  Vec3 way{};
  Vec3 inverse{};  ///< 1 / way, by component; infinite where it does not move
};

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Share of a segment by which tests are generous; rounding is a millionth of it.
constexpr double kSlack = 1e-9;

/// Share of the segment at which it enters the box; kNever: it does not.
double entry_share(const BoxNode& box, const Segment& s) noexcept {
  double enter = -kSlack, leave = 1 + kSlack;
  for (std::size_t i = 0; i < 3; ++i) {
    const double min = static_cast<double>(box.min[i]) - s.from[i];
    const double max = static_cast<double>(box.max[i]) - s.from[i];
    if (s.way[i] == 0) {
      if (min > 0 || max < 0) return kNever;
      continue;
    }
    const double one = min * s.inverse[i], other = max * s.inverse[i];
    const double in = one < other ? one : other, out = one < other ? other : one;
    enter = in > enter ? in : enter;
    leave = out < leave ? out : leave;
  }
  return enter <= leave + kSlack ? enter : kNever;
}

/// Share of the segment at which it goes through a triangle from outside; kNever: it does not.
/// The three edge tests are exact negatives of those of the neighbours: no gap between triangles.
double crossing_share(const MeshTriangle& t, const Segment& s) noexcept {
  const double start = dot(t.normal, s.from - t.corner[0]);
  const double change = dot(t.normal, s.way);
  if (!(change < 0) || start + change >= 0 || start < kSlack * change) return kNever;
  const Vec3 a = t.corner[0] - s.from, b = t.corner[1] - s.from, c = t.corner[2] - s.from;
  if (dot(s.way, cross(a, b)) > 0 || dot(s.way, cross(b, c)) > 0 || dot(s.way, cross(c, a)) > 0)
    return kNever;
  return -start / change;
}

}  // namespace

TrianglePoint nearest_of_all(const Mesh& mesh, const Vec3& p, TrianglePoint best) noexcept {
  BoxStack stack;
  stack.push(0, 0);
  for (std::uint32_t index; stack.pop_below(best.squared, index);) {
    const BoxNode& node = mesh.tree.nodes[index];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const MeshTriangle& triangle = mesh.triangles[i];
      const double height = dot(triangle.normal, p - triangle.corner[0]);
      if (height * height >= best.squared) continue;
      const TrianglePoint here = nearest_on(mesh, i, p);
      if (here.squared < best.squared) best = here;
    }
    if (node.count == 0)
      push_children(stack, node.first, squared_distance(mesh.tree.nodes[node.first], p),
                    squared_distance(mesh.tree.nodes[node.first + 1], p));
  }
  return best;
}

SurfacePoint nearest_surface(const Mesh& mesh, const Vec3& point, double reach) noexcept {
  const TrianglePoint best = nearest_of_all(mesh, point, {.squared = reach * reach});
  return best.triangle == kNoTriangle ? SurfacePoint{} : seen_from(mesh, best, point);
}

std::uint32_t first_crossing(const Mesh& mesh, const Vec3& a, const Vec3& b) noexcept {
  const Vec3 way = b - a;
  const Segment segment{a, way, {1 / way.x, 1 / way.y, 1 / way.z}};
  std::uint32_t first = kNoTriangle;
  double share = kNever;
  BoxStack stack;
  stack.push(0, entry_share(mesh.tree.nodes[0], segment));
  for (std::uint32_t index; stack.pop_below(share, index);) {
    const BoxNode& node = mesh.tree.nodes[index];
    for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
      const double here = crossing_share(mesh.triangles[i], segment);
      if (!(here < share)) continue;
      share = here;
      first = i;
    }
    if (node.count == 0)
      push_children(stack, node.first, entry_share(mesh.tree.nodes[node.first], segment),
                    entry_share(mesh.tree.nodes[node.first + 1], segment));
  }
  return first;
}

}  // namespace hapticd::control
