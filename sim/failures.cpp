#include "sim/failures.h"

#include <algorithm>
#include <cmath>

#include "sim/time_grid.h"

namespace hapticd::sim {

Failures::Failures(const std::vector<Failure>& failures, double period_s) {
  windows_.reserve(failures.size());
  for (const Failure& failure : failures) {
    const std::int64_t begin = tick_at(failure.at_s, period_s);
    const std::int64_t ticks = tick_at(failure.for_s, period_s);
    windows_.push_back({failure, begin, begin + std::max<std::int64_t>(ticks, 1), false});
  }
}

bool Failures::on(FailureKind kind) const noexcept {
  return std::any_of(windows_.begin(), windows_.end(), [&](const Window& window) {
    return window.failure.kind == kind && on(window);
  });
}

bool Failures::on(FailureKind kind, std::size_t axis) const noexcept {
  return std::any_of(windows_.begin(), windows_.end(), [&](const Window& window) {
    return window.failure.kind == kind && window.failure.axis == axis && on(window);
  });
}

double Failures::jump_m(std::size_t axis) const noexcept {
  double sum_m = 0;
  for (const Window& window : windows_) {
    if (window.failure.kind == FailureKind::jump && window.failure.axis == axis && on(window)) {
      sum_m += window.failure.size_m;
    }
  }
  return sum_m;
}

std::int64_t Failures::take_burn_ns() noexcept {
  std::int64_t sum_ns = 0;
  for (Window& window : windows_) {
    if (window.failure.kind != FailureKind::slow || window.spent || window.begin > tick_) continue;
    window.spent = true;
    sum_ns += std::llround(window.failure.for_s * 1e9);
  }
  return sum_ns;
}

}  // namespace hapticd::sim
