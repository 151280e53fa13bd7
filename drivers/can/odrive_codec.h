// ODrive's CANSimple protocol, firmware 0.6: frames to bytes and back. Pure: no socket, no clock, no state.
//
// An id is node << 5 | command. All is little endian, floats are IEEE single. Units are the drive's: turns, turns/s, N m
// at the motor, A, V, degrees Celsius.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>

#include "drivers/can/frame.h"

namespace hapticd::can::odrive {

/// 63 is the address of drives that have none yet.
inline constexpr std::uint8_t kMaxNode = 62;

enum class Command : std::uint8_t {
  get_version = 0x00,
  heartbeat = 0x01,
  estop = 0x02,
  get_error = 0x03,
  set_axis_state = 0x07,
  get_encoder_estimates = 0x09,
  set_controller_mode = 0x0b,
  set_input_pos = 0x0c,
  set_input_vel = 0x0d,
  set_input_torque = 0x0e,
  set_limits = 0x0f,
  get_iq = 0x14,
  get_temperature = 0x15,
  reboot = 0x16,
  get_bus_voltage_current = 0x17,
  clear_errors = 0x18,
  get_torques = 0x1c,
};

enum class AxisState : std::uint32_t { idle = 1, closed_loop = 8 };
enum class ControlMode : std::uint32_t { torque = 1, velocity = 2, position = 3 };
enum class InputMode : std::uint32_t { passthrough = 1, torque_ramp = 6 };

// -- to the drive

Frame set_axis_state(std::uint8_t node, AxisState state) noexcept;
Frame set_controller_mode(std::uint8_t node, ControlMode control, InputMode input) noexcept;
/// Four bytes: three axes at 1 kHz then fit on a bus. Nothing where the torque is not finite.
std::optional<Frame> set_input_torque(std::uint8_t node, double torque_Nm) noexcept;
/// Velocity in turns/s, feed-forward in the drive's steps of 0.001.
std::optional<Frame> set_input_pos(std::uint8_t node, double turns, double velocity,
                                   double torque_Nm) noexcept;
std::optional<Frame> set_input_vel(std::uint8_t node, double velocity, double torque_Nm) noexcept;
std::optional<Frame> set_limits(std::uint8_t node, double velocity, double current_A) noexcept;
Frame clear_errors(std::uint8_t node) noexcept;
Frame estop(std::uint8_t node) noexcept;
Frame reboot(std::uint8_t node) noexcept;
/// Asks for a message of the drive; the length of what is asked for is in the frame.
Frame request(std::uint8_t node, Command command) noexcept;

// -- from the drive

struct Version {
  std::uint8_t protocol = 0;
  std::uint8_t hardware[3] = {};
  std::uint8_t firmware[3] = {};
  bool unreleased = false;
};
struct Heartbeat {
  std::uint32_t error = 0;
  std::uint8_t state = 0;
  std::uint8_t procedure_result = 0;
  bool trajectory_done = false;
};
struct Errors {
  std::uint32_t active = 0, disarm_reason = 0;
};
struct Estimates {
  float position_turns = 0, velocity_turns_s = 0;
};
struct Currents {
  float setpoint_A = 0, measured_A = 0;
};
/// NaN: the drive has no such sensor.
struct Temperatures {
  float fet_C = 0, motor_C = 0;
};
struct Supply {
  float voltage_V = 0, current_A = 0;
};
struct Torques {
  float target_Nm = 0, estimate_Nm = 0;
};

enum class Received : std::uint8_t {
  ok,
  ignore,        ///< not of this node, or nothing that is used here
  malformed,     ///< of this node, and shorter than such a message is
  non_finite,    ///< a sample that is none
  other_master,  ///< a command to this node that somebody else sent
  error_frame,   ///< of the controller
};
using Message = std::variant<std::monostate, Version, Heartbeat, Errors, Estimates, Currents,
                             Temperatures, Supply, Torques>;
struct Decoded {
  Received received = Received::ignore;
  Message message{};  ///< where `ok`
};
Decoded decode(const Frame& frame, std::uint8_t node) noexcept;

/// Word of one error bit, 0 to 31; empty: it has none.
std::string_view error_word(int bit) noexcept;

}  // namespace hapticd::can::odrive
