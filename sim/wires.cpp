#include "sim/wires.h"

#include <algorithm>
#include <limits>

#include "sim/time_grid.h"

namespace hapticd::sim {

Wires::Wires(const AxisOptions& axis, double period_s, std::uint64_t seed, std::size_t index)
    : encoder_(axis),
      amplifier_(axis),
      noise_(seed, index),
      noise_counts_(axis.noise_counts),
      index_m_(axis.index_m.value_or(std::numeric_limits<double>::quiet_NaN())),
      efforts_(whole_periods(axis.delay_s, period_s) + 2, 0.0) {}

void Wires::next_period() noexcept {
  std::copy_backward(efforts_.begin(), efforts_.end() - 1, efforts_.end());
  efforts_.front() = held_N_;
}

double Wires::command(double effort_N) noexcept {
  held_N_ = amplifier_.carried_N(effort_N);
  return held_N_;
}

void Wires::cut() noexcept {
  held_N_ = 0;
  std::fill(efforts_.begin(), efforts_.end(), 0.0);
}

double Wires::read_encoder(double position_m, double offset_m) noexcept {
  if (passed_index_) index_ = {true, encoder_.counts(index_m_ + offset_m, 0)};
  passed_index_ = false;
  const double noise = noise_counts_ > 0 ? noise_counts_ * noise_.normal() : 0;
  return encoder_.counts(position_m + offset_m, noise);
}

}  // namespace hapticd::sim
