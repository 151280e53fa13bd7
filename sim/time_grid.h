// How device time is cut: ticks into sub-steps, sub-steps where a delayed effort changes.
#pragma once
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "control/core/capacity.h"

namespace hapticd::sim {

/// A period and its `substeps` equal parts.
struct TimeGrid {
  double period_s = 0;
  int substeps = 1;
  double substep_s() const noexcept { return period_s / substeps; }
};

/// The first tick at or after `at_s`; 0.3 s at 1 kHz is tick 300, although 0.3 / 0.001 is more.
std::int64_t tick_at(double at_s, double period_s) noexcept;

/// Ticks to run from one tick to another. A longer gap is not made up for: after a suspended night
/// the servo thread would simulate all of it in one tick.
inline constexpr std::int64_t kMaxCatchUpTicks = 1000;
inline std::int64_t owed_ticks(std::int64_t from, std::int64_t to) noexcept {
  return std::min(to - from, kMaxCatchUpTicks);
}

/// Whole periods in a delay.
std::size_t whole_periods(double delay_s, double period_s) noexcept;

/// A run of time in which every effort is held: a sub-step, or a part of one.
struct Segment {
  double begin_s = 0;  ///< within its sub-step
  double end_s = 0;
  bool last = true;  ///< of its sub-step
  /// By axis: periods since the command that acts.
  std::array<std::uint16_t, kMaxAxes> effort_age{};
};

/// The segments of one period for axes with these delays; at most kMaxAxes. A delay of n
/// periods and a rest: the command of n+1 periods ago acts until the rest has passed, then that of
/// n periods ago. Set-up only.
std::vector<Segment> cut_period(TimeGrid grid, std::span<const double> delays_s);

}  // namespace hapticd::sim
