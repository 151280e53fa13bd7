#include "control/identify/held_loss.h"

#include <algorithm>
#include <cmath>

namespace hapticd::identify {
namespace {

constexpr double kWindow_s = 0.5;
constexpr double kMoved = 1e-3;  // of the window that moved most: less tells nothing

}  // namespace

HeldLoss::HeldLoss(std::size_t axes, std::size_t axis, double period_s)
    : axis_(axis), period_s_(period_s), windows_(1) {
  for (Sample& sample : samples_) {
    sample.position.assign(axes, 0);
    sample.effort.assign(axes, 0);
  }
}

void HeldLoss::tick(std::span<const double> positions, std::span<const double> efforts) {
  Sample& newest = samples_[ticks_ % kSpan];
  newest.position.assign(positions.begin(), positions.end());
  newest.effort.assign(efforts.begin(), efforts.end());
  if (++ticks_ < kSpan) return;
  const Sample& oldest = samples_[ticks_ % kSpan];
  const Sample& middle = samples_[(ticks_ + kSpan / 2) % kSpan];
  const auto velocity = [&](std::size_t i) {
    return (newest.position[i] - oldest.position[i]) / ((kSpan - 1) * period_s_);
  };
  if (static_cast<double>(in_window_++) * period_s_ >= kWindow_s) {
    windows_.emplace_back();
    in_window_ = 1;
  }
  Window& window = windows_.back();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const double v = velocity(i);
    if (!std::isfinite(v)) return;
    if (i == axis_) {
      window.moved += v * v;
      continue;
    }
    window.work -= middle.effort[i] * v;
    window.held += v * v;
    window.slid += std::abs(v);
  }
}

double HeldLoss::most(double viscous, double coulomb) const {
  const double moved = std::ranges::max(windows_, {}, &Window::moved).moved;
  double most = 0;
  for (const Window& window : windows_) {
    if (!(window.moved > kMoved * moved)) continue;
    const double taken = window.work + viscous * window.held + coulomb * window.slid;
    most = std::max(most, taken / window.moved);
  }
  return most;
}

}  // namespace hapticd::identify
