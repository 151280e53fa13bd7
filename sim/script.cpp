#include "sim/script.h"

#include <cmath>

namespace hapticd::sim {

Script::Script(const std::vector<ScriptStep>& steps, double start_m, double substep_s) {
  points_.push_back({0, 0, start_m, 0});
  for (const ScriptStep& step : steps) {
    points_.push_back({std::llround(step.at_s / substep_s), step.force_N, step.position_m, 0});
  }
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const std::int64_t substeps = points_[i + 1].substep - points_[i].substep;
    if (substeps > 0) {
      points_[i].rate_m_s =
          (points_[i + 1].rest_m - points_[i].rest_m) / (static_cast<double>(substeps) * substep_s);
    }
  }
}

ScriptValue Script::at(std::int64_t substep) noexcept {
  if (substep < 0) return {0, points_[0].rest_m, 0};
  while (current_ + 1 < points_.size() && points_[current_ + 1].substep <= substep) ++current_;
  const Point& from = points_[current_];
  if (current_ + 1 == points_.size()) return {from.force_N, from.rest_m, 0};
  const Point& to = points_[current_ + 1];
  const double share =
      static_cast<double>(substep - from.substep) / static_cast<double>(to.substep - from.substep);
  return {from.force_N, from.rest_m + share * (to.rest_m - from.rest_m), from.rate_m_s};
}

}  // namespace hapticd::sim
