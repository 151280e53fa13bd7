// What a moteus servo is told to do. A write to the mode register begins a new command, in which
// every field that is not written has its default.
#pragma once
#include <cstdint>
#include <limits>

namespace hapticd::sim::can {

enum class MoteusMode : std::uint8_t {
  stopped = 0,
  fault = 1,
  enabling = 2,
  calibrating = 3,
  calibrated = 4,
  pwm = 5,
  current = 9,
  position = 10,
  timeout = 11,
  zero_velocity = 12,
  stay_within = 13,
  brake = 15,
};

struct MoteusCommand {
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  double mode = 0;
  double position = 0;  ///< NaN: where the servo is
  double velocity = 0;
  double feedforward_Nm = 0;
  double kp_scale = 1, kd_scale = 1, ilimit_scale = 1;
  double max_torque_Nm = 100;  ///< NaN: no limit
  double stop_position = kNaN;
  double timeout_s = 0;  ///< 0: as configured; NaN: none
  double velocity_limit = kNaN, acceleration_limit = kNaN;
  double fixed_voltage = kNaN, fixed_current = kNaN;
  double ignore_bounds = 0;
  double lower = kNaN, upper = kNaN;  ///< of mode 13; NaN: none
};

/// The field that a register writes and reads; nullptr: none. 0x042..0x048 are other names.
inline double* moteus_field(MoteusCommand& command, std::uint32_t reg) {
  switch (reg) {
    case 0x000:
      return &command.mode;
    case 0x020:
      return &command.position;
    case 0x021:
      return &command.velocity;
    case 0x022:
    case 0x042:
      return &command.feedforward_Nm;
    case 0x023:
    case 0x043:
      return &command.kp_scale;
    case 0x024:
    case 0x044:
      return &command.kd_scale;
    case 0x025:
    case 0x045:
      return &command.max_torque_Nm;
    case 0x026:
      return &command.stop_position;
    case 0x027:
    case 0x046:
      return &command.timeout_s;
    case 0x028:
      return &command.velocity_limit;
    case 0x029:
      return &command.acceleration_limit;
    case 0x02a:
      return &command.fixed_voltage;
    case 0x02b:
    case 0x047:
      return &command.ilimit_scale;
    case 0x02c:
      return &command.fixed_current;
    case 0x02d:
    case 0x048:
      return &command.ignore_bounds;
    case 0x040:
      return &command.lower;
    case 0x041:
      return &command.upper;
    default:
      return nullptr;
  }
}

}  // namespace hapticd::sim::can
