#include "sim/time_grid.h"

#include <algorithm>
#include <cmath>

namespace hapticd::sim {
namespace {

constexpr double kSnap = 1e-9;  // of a period: closer than this is the same time

}  // namespace

std::int64_t tick_at(double at_s, double period_s) noexcept {
  return static_cast<std::int64_t>(std::ceil(at_s / period_s - kSnap));
}

std::size_t whole_periods(double delay_s, double period_s) noexcept {
  return static_cast<std::size_t>(std::floor(delay_s / period_s + kSnap));
}

std::vector<Segment> cut_period(TimeGrid grid, std::span<const double> delays_s) {
  const double substep_s = grid.substep_s(), snap_s = kSnap * grid.period_s;
  std::vector<Segment> segments;
  for (int substep = 0; substep < grid.substeps; ++substep) {
    const auto until_change_s = [&](double delay_s) {
      const auto whole = static_cast<double>(whole_periods(delay_s, grid.period_s));
      return std::max(0.0, delay_s - whole * grid.period_s) - substep * substep_s;
    };
    std::vector<double> ends_s;
    for (const double delay_s : delays_s) ends_s.push_back(until_change_s(delay_s));
    std::erase_if(ends_s, [&](double s) { return s <= snap_s || s >= substep_s - snap_s; });
    std::sort(ends_s.begin(), ends_s.end());
    ends_s.push_back(substep_s);
    double begin_s = 0;
    for (const double end_s : ends_s) {
      if (end_s - begin_s <= snap_s) continue;
      Segment segment{begin_s, end_s, end_s == substep_s, {}};
      for (std::size_t i = 0; i < delays_s.size(); ++i) {
        const bool older = until_change_s(delays_s[i]) >= end_s - snap_s;
        segment.effort_age[i] =
            static_cast<std::uint16_t>(whole_periods(delays_s[i], grid.period_s) + older);
      }
      segments.push_back(segment);
      begin_s = end_s;
    }
  }
  return segments;
}

}  // namespace hapticd::sim
