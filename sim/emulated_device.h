// Motors of emulated electronics, joined with a mechanical truth.
#pragma once
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "control/core/result.h"
#include "sim/motor.h"
#include "sim/options.h"
#include "sim/sim_device.h"

namespace hapticd::sim {

/// Motors of one device and what they move: the simulated device of the config, run in steps of
/// `step_s`. Its hand's script starts when the first motor is enabled.
class EmulatedDevice {
 public:
  /// effort [N or N m] = torque * effort_per_torque,
  /// turns (or counts, as the motor's encoder has it) = turns_per_unit * position + offset_turns
  struct Joint {
    Motor* motor = nullptr;
    double turns_per_unit = 1;  ///< a m or rad
    double offset_turns = 0;
    double effort_per_torque = 1;
  };

  /// `truth` as a config gives it; its encoders are replaced by ideal ones, its delays and failures
  /// by none: these are the electronics' and the bus'. Axis i is moved by joints[i].
  EmulatedDevice(DeviceOptions truth, std::vector<Joint> joints, double step_s = 125e-6);

  /// Errors: options out of range, joints that do not fit the axes.
  Result<void> start();
  /// Moves the mechanics to now with the torques of the motors, then move_to() for each motor. The
  /// first call sets the time. Between steps an axis goes on with its velocity.
  void advance(std::int64_t now_ns);
  /// [m or rad] as the motors were told last.
  double position(std::size_t axis) const;
  const SimDevice& truth() const { return device_; }

 private:
  void step();
  void move_motors();
  std::int64_t step_end_ns() const;

  std::vector<Joint> joints_;
  double step_s_;
  SimDevice device_;
  std::vector<AxisSample> samples_;
  std::vector<double> efforts_, delivered_;
  std::int64_t start_ns_ = 0, now_ns_ = 0;
  std::int64_t tick_ = 0;
  bool running_ = false, armed_ = false;
};

/// Of a motor that counts turns and makes N m, behind a transmission without loss.
inline EmulatedDevice::Joint turning(Motor& motor, double turns_per_unit = 1,
                                     double offset_turns = 0) {
  return {.motor = &motor,
          .turns_per_unit = turns_per_unit,
          .offset_turns = offset_turns,
          .effort_per_torque = 2 * std::numbers::pi * turns_per_unit};
}

}  // namespace hapticd::sim
