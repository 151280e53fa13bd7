// The two converters between an axis and its wires.
#pragma once
#include <algorithm>
#include <cmath>

#include "sim/options.h"

namespace hapticd::sim {

/// floor((x - zero) counts_per_m + noise), wrapped into [0, 2^bits) unless bits is 0. Negative
/// counts_per_m: reversed. A relative encoder has its zero where the axis starts.
class Encoder {
 public:
  explicit Encoder(const AxisOptions& options) noexcept
      : counts_per_m_(options.counts_per_m),
        zero_m_(options.relative ? options.position_m : options.zero_m),
        modulus_(options.encoder_bits > 0 ? std::ldexp(1.0, options.encoder_bits) : 0) {}

  double counts(double position_m, double noise_counts) const noexcept {
    const double counts = std::floor((position_m - zero_m_) * counts_per_m_ + noise_counts);
    return modulus_ > 0 ? counts - modulus_ * std::floor(counts / modulus_) : counts;
  }

 private:
  double counts_per_m_;
  double zero_m_;
  double modulus_;  ///< a power of two, so the wrap is exact
};

/// What an amplifier makes of an effort: the nearest of its steps (half a step: away from zero)
/// within its range.
class Amplifier {
 public:
  explicit Amplifier(const AxisOptions& options) noexcept
      : step_N_(options.dac_step_N), limit_N_(options.max_effort_N) {
    // The largest step within the range; the slack forgives 8 / 0.1 = 79.999...
    if (step_N_ > 0) limit_N_ = step_N_ * std::floor(options.max_effort_N / step_N_ * (1 + 1e-12));
  }

  double carried_N(double effort_N) const noexcept {
    if (std::isnan(effort_N)) return 0;
    const double bounded = std::clamp(effort_N, -limit_N_, limit_N_);
    return step_N_ > 0 ? step_N_ * std::round(bounded / step_N_) : bounded;
  }

 private:
  double step_N_;
  double limit_N_;
};

}  // namespace hapticd::sim
