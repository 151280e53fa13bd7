#include "control/identify/windows.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace hapticd::identify {
namespace {

constexpr std::size_t kReach = 6;            // samples on either side of a window's start
constexpr std::size_t kShortestQuarter = 8;  // samples of a window

Motion start_at(const Record& record, std::size_t at) {
  const auto& samples = record.samples;
  const std::size_t first = at - std::min(at, kReach);
  const std::size_t last = std::min(samples.size(), at + kReach + 1);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double count = 0;
  for (std::size_t i = first; i < last; ++i) {
    if (!samples[i].fresh) continue;
    const double s = static_cast<double>(i) - static_cast<double>(at);
    const Eigen::Vector3d row(1, s, s * s);
    normal += row * row.transpose();
    right += row * (samples[i].position - samples[at].position);
    ++count;
  }
  if (count < 4) return {.position = samples[at].position};
  const Eigen::Vector3d p = normal.ldlt().solve(right);
  return {.position = samples[at].position + p(0), .velocity = p(1) / record.period_s};
}

/// The tick between two at which the axis moves fastest.
std::size_t fastest(const Record& record, std::size_t first, std::size_t last) {
  const auto moved = [&](std::size_t at) {
    if (at < kReach || at + kReach >= record.samples.size()) return -1.0;
    return std::abs(record.samples[at + kReach].position - record.samples[at - kReach].position);
  };
  std::size_t best = first;
  for (std::size_t at = first; at < last; ++at) {
    if (moved(at) > moved(best)) best = at;
  }
  return best;
}

}  // namespace

std::vector<Window> cut(const Record& record, double length_s, std::size_t skip) {
  const auto quarter = std::max<std::size_t>(
      kShortestQuarter, static_cast<std::size_t>(std::lround(length_s / 4 / record.period_s)));
  std::vector<Window> windows;
  std::size_t begin = fastest(record, skip, skip + quarter);
  while (begin + 5 * quarter <= record.samples.size()) {
    const std::size_t end = fastest(record, begin + 3 * quarter, begin + 5 * quarter);
    windows.push_back({.begin = begin, .end = end, .start = start_at(record, begin)});
    begin = end;
  }
  return windows;
}

// A delay of n periods and a rest: in each period the effort of n + 1 ticks before acts until the
// rest has passed, then that of n ticks before.
void predict(const Record& record, const Dynamics& axis, const Window& window,
             std::span<double> out) noexcept {
  const double whole = std::floor(axis.delay_s / record.period_s);
  const double rest_s = axis.delay_s - whole * record.period_s;
  const Interval before = interval(axis, rest_s);
  const Interval after = interval(axis, record.period_s - rest_s);
  const auto age = static_cast<std::size_t>(whole);
  const auto effort = [&](std::size_t tick, std::size_t ticks_ago) {
    return tick >= ticks_ago ? record.samples[tick - ticks_ago].effort : 0.0;
  };
  Motion motion = window.start;
  motion.friction = motion.velocity == 0 ? 0 : std::copysign(1.0, motion.velocity);
  out[0] = motion.position;
  for (std::size_t i = 1; i < out.size(); ++i) {
    const std::size_t tick = window.begin + i - 1;
    advance(axis, before, effort(tick, age + 1) + axis.bias, motion);
    advance(axis, after, effort(tick, age) + axis.bias, motion);
    out[i] = motion.position;
  }
}

}  // namespace hapticd::identify
