// A drive's own clock, in the host's time.
#pragma once
#include <cmath>
#include <cstdint>

#include "sim/can/drive.h"

namespace hapticd::sim::can {

/// Fast by the share `drift`: what it takes for a second is over after 1 / (1 + drift) s.
class DriveClock {
 public:
  explicit DriveClock(double drift) : ns_per_s_(1e9 / (1 + drift)) {}

  double ns(double own_s) const { return own_s * ns_per_s_; }
  /// The end of a time that begins at `from_ns`; kNever if it has none, or lasts for years.
  std::int64_t end_ns(std::int64_t from_ns, double own_s) const {
    return own_s < 1e8 ? from_ns + std::llround(ns(own_s)) : kNever;
  }
  double own_s(std::int64_t time_ns) const { return static_cast<double>(time_ns) / ns_per_s_; }

 private:
  double ns_per_s_;
};

/// Something done again and again on a drive's clock; rounding does not add up.
class Cycle {
 public:
  Cycle() = default;
  /// Never, if the period is 0.
  Cycle(std::int64_t first_ns, double period_ns) : first_ns_(first_ns), period_ns_(period_ns) {}

  std::int64_t next_ns() const {
    if (!(period_ns_ > 0)) return kNever;
    return first_ns_ + std::llround(static_cast<double>(count_) * period_ns_);
  }
  void done() { ++count_; }

 private:
  std::int64_t first_ns_ = 0;
  double period_ns_ = 0;
  std::int64_t count_ = 0;
};

}  // namespace hapticd::sim::can
