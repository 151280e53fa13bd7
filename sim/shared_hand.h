// One linear hand on the axes of several simulated devices, which therefore move together: the
// first device that asks for a tick runs them all up to it. The loop asks all devices for a tick
// after it commanded all of them in the last one, so by then every effort is known.
//
//   auto hand = std::make_shared<SharedHand>(options, devices);
//   SimDevice left(hand, 0), right(hand, 1);
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/options.h"
#include "sim/shared_plant.h"
#include "sim/time_grid.h"
#include "sim/truth.h"
#include "sim/wires.h"

namespace hapticd::sim {

class SharedHand {
 public:
  /// `devices`: all that HeldAxis::device counts; those that the hand does not touch are ignored.
  SharedHand(SharedHandOptions options, std::vector<DeviceOptions> devices);

  /// Names one of its axes.
  bool holds(std::size_t device) const noexcept;
  const DeviceOptions& device(std::size_t number) const { return devices_.at(number); }
  /// What is wrong with the options (check_shared_hand.h); empty: nothing.
  std::string problem() const;
  /// All axes back to the start. Each of the devices does so when it connects; without a problem()
  /// only. Allocates all that the loop needs.
  void restart();

  // -- in the loop; `device` is one that the hand holds
  /// All axes stand at the start of this tick afterwards. The first call sets where time starts.
  void run_until(std::int64_t tick) noexcept;
  /// Of the device's axes; empty before restart().
  std::span<Wires> wires(std::size_t device) noexcept;
  const Truth& truth(std::size_t device, std::size_t axis) const noexcept {
    return truth_[first_[device] + axis];
  }
  /// Positions [m] at the ends of the sub-steps of the last period.
  std::span<const double> trace(std::size_t device, std::size_t axis) const noexcept {
    return trace_[first_[device] + axis];
  }
  /// Of the hand on the axis.
  double force_N(std::size_t device, std::size_t axis) const noexcept {
    return plant_->hand_force_N(first_[device] + axis);
  }

 private:
  struct Piece {
    Segment segment;
    std::size_t propagator = 0;
  };
  void lay_out();
  void cut_time();
  std::size_t propagator_for(double length_s);
  void run_tick() noexcept;
  void run_piece(const Piece& piece) noexcept;
  void observe_substep(std::size_t substep) noexcept;

  SharedHandOptions options_;
  std::vector<DeviceOptions> devices_;
  std::vector<AxisOptions> axes_;   ///< of all devices held, in their order
  std::vector<std::size_t> first_;  ///< by device: its first one
  std::optional<SharedPlant> plant_;
  std::vector<SharedPropagator> propagators_;  ///< one for each length
  std::vector<Piece> pieces_;                  ///< of one period
  std::vector<Wires> wires_;
  std::vector<Truth> truth_;
  std::vector<std::vector<double>> trace_;
  std::int64_t tick_ = 0;  ///< the axes stand at the start of this one
  bool started_ = false;   ///< tick_ is known
};

}  // namespace hapticd::sim
