#include "control/identify/hold.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hapticd::identify {
namespace {

constexpr double kCornerTicks = 60;       // of a hold on a known mass
constexpr double kSoftDamperPeriods = 8;  // damper / spring of a soft hold
constexpr double kHeldWeight_s = 0.3;     // spring / integrator of the weight
constexpr double kFinding_s = 1;          // of the weight: until then it may give way

}  // namespace

Hold::Hold(const HoldOptions& options, double period_s) noexcept
    : period_s_(period_s), force_(options.force) {
  if (options.mass > 0) {
    const double corner = 2 * std::numbers::pi / (kCornerTicks * period_s);
    stiffness_ = options.mass * corner * corner;
    damping_ = 2 * options.mass * corner;
  } else {
    stiffness_ = options.force / options.travel;
    damping_ = kSoftDamperPeriods * period_s * stiffness_;
  }
}

double Hold::tick(double position, bool fresh) noexcept {
  if (!fresh || !std::isfinite(position)) return effort_;
  if (!started_) {
    started_ = true;
    middle_ = position;
    last_.fill(position);
  }
  std::copy_backward(last_.begin(), last_.end() - 1, last_.end());
  last_[0] = position;
  const double deviation = position - middle_;
  const double velocity = (last_.front() - last_.back()) / (2 * period_s_);
  held_s_ += period_s_;
  if (held_s_ > kFinding_s) strayed_ = std::max(strayed_, std::abs(deviation));
  weight_ =
      std::clamp(weight_ - stiffness_ * deviation * period_s_ / kHeldWeight_s, -force_, force_);
  effort_ = std::clamp(weight_ - stiffness_ * deviation - damping_ * velocity, -force_, force_);
  return effort_;
}

}  // namespace hapticd::identify
