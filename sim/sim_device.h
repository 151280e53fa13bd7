// A simulated device behind the interface that real ones have. It runs inside the servo thread:
// after connect() it neither allocates, nor locks, logs or throws, and it needs no thread and no
// clock. Device time is the tick's number times the period, so that a run in virtual time and one
// in real time with the same ticks give the same bits.
//
//   request   the plants run from the last tick to this one; the encoders are read
//   collect   hands out the readings; the power stage goes on or off here
//   command   efforts from now on (after each axis' delay)
//
// Devices that share a hand run together, in the request of the first of them (shared_hand.h).
// Missed ticks are time in which the last effort is held, as on a real device.
#pragma once
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device.h"
#include "sim/axis.h"
#include "sim/failures.h"
#include "sim/linkage.h"
#include "sim/noise.h"
#include "sim/options.h"
#include "sim/shared_hand.h"
#include "sim/wires.h"

namespace hapticd::sim {

class SimDevice final : public drivers::Device {
 public:
  explicit SimDevice(DeviceOptions options);
  /// Number `device` of those that share the hand.
  SimDevice(std::shared_ptr<SharedHand> hand, std::size_t device);

  /// Starts the truth anew: two runs after two connects are the same. Errors: options out of range.
  Result<drivers::DeviceInfo> connect() override;
  void disconnect() noexcept override;

  void request(const drivers::TickTime& time) noexcept override;
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override;
  void command(std::span<const double> effort, std::span<double> delivered) noexcept override;
  void set_armed(bool armed) noexcept override { arm_wanted_ = armed; }
  void stop() noexcept override;
  std::string fault_text() const override;

  const DeviceOptions& options() const noexcept { return options_; }
  /// As of the last request(); axis < options().axes.size(), after connect().
  const Truth& truth(std::size_t axis) const noexcept {
    if (hand_) return hand_->truth(number_, axis);
    return linkage_ ? linkage_->truth(axis) : axes_[axis].truth();
  }
  /// As of the last request(); only of a device with options().linkage, after connect().
  const TipTruth& tip() const noexcept { return linkage_->tip(); }
  /// Positions [m] of an axis at the ends of the sub-steps of the last period that was simulated.
  std::span<const double> trace(std::size_t axis) const noexcept {
    if (hand_) return hand_->trace(number_, axis);
    return linkage_ ? linkage_->trace(axis) : axes_[axis].trace();
  }

 private:
  struct DigitalChange {
    std::int64_t tick = 0;  ///< of device time, from which on
    std::uint32_t bits = 0;
  };
  std::span<Wires> wires() noexcept {
    return hand_ ? hand_->wires(number_) : std::span<Wires>(wires_);
  }
  std::string problem() const;
  void make_plants();
  void make_inputs();
  std::int64_t script_substep() const noexcept;
  void run_until(std::int64_t tick) noexcept;
  void run_tick() noexcept;
  void measure(std::int64_t stamp_ns) noexcept;
  void measure_force() noexcept;
  std::uint32_t digital() const noexcept;
  void switch_power() noexcept;

  DeviceOptions options_;
  std::size_t number_ = 0;    ///< of this device, to the hand
  std::vector<Wires> wires_;  ///< of every axis; a shared hand has its own
  // One of the three moves.
  std::shared_ptr<SharedHand> hand_;
  std::vector<Axis> axes_;
  std::optional<Linkage> linkage_;
  std::vector<AxisSample> samples_;
  std::vector<std::int64_t> homed_tick_;  ///< by axis: of device time
  std::vector<DigitalChange> digital_;
  std::vector<Noise> force_noise_;  ///< a channel of the force sensor each
  std::array<double, 6> analogue_{};
  Failures failures_;
  std::int64_t ramp_substeps_ = 0;
  std::int64_t first_tick_ = 0;
  std::int64_t tick_ = 0;        ///< the plants stand at the start of this one
  std::int64_t armed_tick_ = 0;  ///< the power stage went on in this one
  bool started_ = false;         ///< first_tick_ is known
  bool arm_wanted_ = false;
  bool armed_ = false;
  bool dropped_out_ = false;
};

}  // namespace hapticd::sim
