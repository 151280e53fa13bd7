// Motors of emulated drives, joined with a mechanical truth.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "control/core/result.h"
#include "sim/can/drive.h"
#include "sim/options.h"
#include "sim/sim_device.h"

namespace hapticd::sim::can {

/// Drives of one device and what they move: the simulated device of the config, run in steps of
/// `step_s`. Its hand's script starts when the first drive is enabled.
class EmulatedDevice {
 public:
  struct Motor {
    Drive* drive = nullptr;
    double turns_per_unit = 1;
    double offset_turns = 0;
  };

  /// `truth` as a config gives it; its encoders are replaced by ideal ones, its delays and failures
  /// by none: these are the drives' and the bus'. Axis i is moved by motors[i]:
  ///   effort [N or N m] = torque * 2 pi * turns_per_unit,
  ///   turns = turns_per_unit * position + offset_turns
  EmulatedDevice(DeviceOptions truth, std::vector<Motor> motors, double step_s = 125e-6);

  /// Errors: options out of range, motors that do not fit the axes.
  Result<void> start();
  /// Moves the mechanics to now with the torques of the drives, then move_to() for each drive. The
  /// first call sets the time. Between steps an axis goes on with its velocity.
  void advance(std::int64_t now_ns);
  /// [m or rad] as the drives were told last.
  double position(std::size_t axis) const;
  const SimDevice& truth() const { return device_; }

 private:
  void step();
  void move_drives();
  std::int64_t step_end_ns() const;

  std::vector<Motor> motors_;
  double step_s_;
  SimDevice device_;
  std::vector<AxisSample> samples_;
  std::vector<double> efforts_, delivered_;
  std::int64_t start_ns_ = 0, now_ns_ = 0;
  std::int64_t tick_ = 0;
  bool running_ = false, armed_ = false;
};

}  // namespace hapticd::sim::can
