#include "control/design/check/pose_five_bar.h"

#include <numbers>

namespace hapticd::check {
namespace {

/// Range of the cosine.
Interval cosine(Interval a) {
  constexpr double kTurn = 2 * std::numbers::pi;
  if (!(a.high - a.low < kTurn)) return {-1, 1};
  const double one = std::cos(a.low), other = std::cos(a.high);
  Interval range = widened(std::min(one, other), std::max(one, other));
  // A multiple of the turn in it: 1; half a turn beside one: -1. Rounding must not miss any.
  constexpr double kSlack = 1e-12;
  const auto holds = [&](double at) {
    return std::floor((a.high - at) / kTurn + kSlack) >= std::ceil((a.low - at) / kTurn - kSlack);
  };
  if (holds(0)) range.high = 1;
  if (holds(std::numbers::pi)) range.low = -1;
  return range;
}

Interval sine(Interval a) {
  return cosine(a - Interval(std::numbers::pi / 2));
}

/// Elbow of an inner link, (cos, sin) of a joint.
struct Elbow {
  Jet<2> cos, sin;
  Elbow(Interval q, std::size_t joint) {
    const Jet<2> angle = Jet<2>::variable(q, joint);
    const Interval c = cosine(q), s = sine(q);
    cos = chain(angle, c, -s, -c);
    sin = chain(angle, s, c, -s);
  }
};

ChartMatrix curvature_of(const Jet<2>& x, const Jet<2>& y, double scale) {
  ChartMatrix n(2, 2);
  for (std::size_t i = 0; i < 2; ++i) {
    for (std::size_t j = 0; j < 2; ++j) {
      const std::size_t k = Jet<2>::pair(i, j);
      n(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          scale * std::hypot(x.bend[k].size(), y.bend[k].size());
    }
  }
  return n;
}

}  // namespace

FiveBarCells::Place FiveBarCells::place(const std::array<Interval, 2>& q) const {
  const Elbow one(q[0], 0), two(q[1], 1);
  const double l = bars_.link_m;
  const Jet2 dx = Jet2(bars_.base_m) + l * (two.cos - one.cos), dy = l * (two.sin - one.sin);
  const Jet2 apart2 = square(dx) + square(dy);
  const Jet2 w = root((l * l) * inverse(apart2) - Jet2(0.25));
  return {apart2.value, (0.5 * l) * (one.cos + two.cos) - w * dy,
          (0.5 * l) * (one.sin + two.sin) + w * dx};
}

bool FiveBarCells::is_singular(const PoseChart& chart, Interval apart2) const {
  if (chart.at_.coordinates != 2) return false;
  const double l2 = bars_.link_m * bars_.link_m;
  const auto height = [&](double t) { return std::max(0.0, t * (l2 - t / 4)); };
  double most = std::max(height(apart2.low), height(apart2.high));
  if (apart2.low <= 2 * l2 && apart2.high >= 2 * l2) most = l2 * l2;
  return chart.beyond_guard(2 * l2 / std::sqrt(most));
}

JointCell FiveBarCells::look(const PoseChart& chart, const Cell& cell) const {
  JointCell seen;
  std::array<Interval, 2> narrow, wide;
  std::array<double, kMaxJoints> middle{};
  for (std::size_t i = 0; i < 2; ++i) {
    const double step = chart.steps_[static_cast<Eigen::Index>(i)];
    narrow[i] = {cell.low[i], cell.high[i]};
    wide[i] = {cell.low[i] - step, cell.high[i] + step};
    middle[i] = cell.middle(i);
  }
  const Place own = place(narrow);
  seen.no_pose = own.apart2.low > 4 * bars_.link_m * bars_.link_m;
  seen.singular = is_singular(chart, own.apart2);
  seen.places = chart.contact_of({own.x.value, own.y.value, Interval(0)});
  control::LinkagePose pose;
  seen.has_middle = control::pose_of(bars_, middle.data(), pose);
  if (seen.no_pose || seen.singular || !seen.has_middle) return seen;
  Eigen::Matrix<double, 3, 2> own_jacobian;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j < 2; ++j)
      own_jacobian(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
          pose.jacobian[i][j];
  seen.jacobian = chart.turn_ * own_jacobian;
  for (std::size_t i = 0; i < chart.at_.coordinates; ++i) {
    seen.x[i] = chart.at_.origin[i];
    for (std::size_t j = 0; j < 3; ++j) seen.x[i] += chart.at_.turn[i][j] * pose.tip[j];
  }
  const Place around = place(wide);
  seen.curvature = curvature_of(around.x, around.y, chart.scale_);
  return seen;
}

}  // namespace hapticd::check
