// What lies between one axis and the loop: encoder with its index pulse, amplifier, and the delay
// of the effort.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/converters.h"
#include "sim/noise.h"
#include "sim/options.h"

namespace hapticd::sim {

/// The latest pulse since connect().
struct IndexPulse {
  bool seen = false;
  double counts = 0;  ///< of the encoder at it
};

class Wires {
 public:
  /// Set-up. `index` of the axis selects the noise stream of `seed`.
  Wires(const AxisOptions& axis, double period_s, std::uint64_t seed, std::size_t index);

  // -- the side of the plant
  /// A period begins: the last command enters the delay line.
  void next_period() noexcept;
  /// [N] commanded that many periods ago.
  double effort_N(std::size_t age) const noexcept { return efforts_[age]; }
  /// The axis moved without turning round between.
  void moved(double from_m, double to_m) noexcept {
    passed_index_ |= (from_m < index_m_) != (to_m < index_m_);
  }

  // -- the side of the loop
  /// The effort from now on, after the delay. Returns what the amplifier makes of it.
  double command(double effort_N) noexcept;
  /// Power off: no force from now on, whatever is still on its way.
  void cut() noexcept;
  /// Counts; `offset_m` is a fault of the encoder. Draws noise: once a tick.
  double read_encoder(double position_m, double offset_m) noexcept;
  const IndexPulse& index() const noexcept { return index_; }

 private:
  Encoder encoder_;
  Amplifier amplifier_;
  Noise noise_;
  double noise_counts_;
  double index_m_;  ///< NaN: there is none
  bool passed_index_ = false;
  IndexPulse index_;
  std::vector<double> efforts_;  ///< [N] by age in periods
  double held_N_ = 0;            ///< the last command
};

}  // namespace hapticd::sim
