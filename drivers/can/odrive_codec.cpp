#include "drivers/can/odrive_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::can::odrive {
namespace {

constexpr double kFeedForwardStep = 0.001F;  // as the drive divides: 0.25 are 249 steps

Frame frame_of(std::uint8_t node, Command command, std::size_t size) noexcept {
  Frame frame;
  frame.id = (std::uint32_t{node} << 5) | static_cast<std::uint32_t>(command);
  frame.size = static_cast<std::uint8_t>(size);
  return frame;
}

/// Does it stay finite as a single?
bool fits(double value) noexcept {
  return std::abs(value) <= std::numeric_limits<float>::max();
}

void put_float(Frame& frame, std::size_t at, double value) noexcept {
  put(frame, at, static_cast<float>(value));
}

std::int16_t in_steps(double value) noexcept {
  const double steps = std::clamp(std::trunc(value / kFeedForwardStep), -32767.0, 32767.0);
  return static_cast<std::int16_t>(steps);
}

std::optional<Frame> two_floats(std::uint8_t node, Command command, double a, double b) noexcept {
  if (!fits(a) || !fits(b)) return std::nullopt;
  Frame frame = frame_of(node, command, 8);
  put_float(frame, 0, a);
  put_float(frame, 4, b);
  return frame;
}

/// Two floats of which neither may be infinite or NaN.
template <class Pair>
Decoded finite_pair(std::span<const std::uint8_t> bytes) noexcept {
  const float a = get<float>(bytes, 0), b = get<float>(bytes, 4);
  if (!std::isfinite(a) || !std::isfinite(b)) return {Received::non_finite, {}};
  return {Received::ok, Pair{a, b}};
}

Decoded temperatures_of(std::span<const std::uint8_t> bytes) noexcept {
  const float fet = get<float>(bytes, 0), motor = get<float>(bytes, 4);
  if (std::isinf(fet) || std::isinf(motor)) return {Received::non_finite, {}};
  return {Received::ok, Temperatures{fet, motor}};
}

Version version_of(std::span<const std::uint8_t> b) noexcept {
  return {.protocol = b[0],
          .hardware = {b[1], b[2], b[3]},
          .firmware = {b[4], b[5], b[6]},
          .unreleased = b[7] != 0};
}

/// Is it one that only hosts send?
bool of_a_host(Command command) noexcept {
  switch (command) {
    case Command::estop:
    case Command::set_axis_state:
    case Command::set_controller_mode:
    case Command::set_input_pos:
    case Command::set_input_vel:
    case Command::set_input_torque:
    case Command::set_limits:
    case Command::reboot:
    case Command::clear_errors:
      return true;
    default:
      return false;
  }
}

bool of_a_drive(Command command) noexcept {
  switch (command) {
    case Command::get_version:
    case Command::heartbeat:
    case Command::get_error:
    case Command::get_encoder_estimates:
    case Command::get_iq:
    case Command::get_temperature:
    case Command::get_bus_voltage_current:
    case Command::get_torques:
      return true;
    default:
      return false;
  }
}

Decoded message_of(Command command, std::span<const std::uint8_t> b) noexcept {
  switch (command) {
    case Command::get_version:
      return {Received::ok, version_of(b)};
    case Command::heartbeat:
      return {Received::ok, Heartbeat{.error = get<std::uint32_t>(b, 0),
                                      .state = b[4],
                                      .procedure_result = b[5],
                                      .trajectory_done = (b[6] & 1) != 0}};
    case Command::get_error:
      return {Received::ok, Errors{get<std::uint32_t>(b, 0), get<std::uint32_t>(b, 4)}};
    case Command::get_encoder_estimates:
      return finite_pair<Estimates>(b);
    case Command::get_iq:
      return finite_pair<Currents>(b);
    case Command::get_temperature:
      return temperatures_of(b);
    case Command::get_bus_voltage_current:
      return finite_pair<Supply>(b);
    case Command::get_torques:
      return finite_pair<Torques>(b);
    default:
      return {};
  }
}

}  // namespace

Frame set_axis_state(std::uint8_t node, AxisState state) noexcept {
  Frame frame = frame_of(node, Command::set_axis_state, 8);
  put(frame, 0, static_cast<std::uint32_t>(state));
  return frame;
}

Frame set_controller_mode(std::uint8_t node, ControlMode control, InputMode input) noexcept {
  Frame frame = frame_of(node, Command::set_controller_mode, 8);
  put(frame, 0, static_cast<std::uint32_t>(control));
  put(frame, 4, static_cast<std::uint32_t>(input));
  return frame;
}

std::optional<Frame> set_input_torque(std::uint8_t node, double torque_Nm) noexcept {
  if (!fits(torque_Nm)) return std::nullopt;
  Frame frame = frame_of(node, Command::set_input_torque, 4);
  put_float(frame, 0, torque_Nm);
  return frame;
}

std::optional<Frame> set_input_pos(std::uint8_t node, double turns, double velocity,
                                   double torque_Nm) noexcept {
  if (!fits(turns) || !fits(velocity) || !fits(torque_Nm)) return std::nullopt;
  Frame frame = frame_of(node, Command::set_input_pos, 8);
  put_float(frame, 0, turns);
  put(frame, 4, in_steps(velocity));
  put(frame, 6, in_steps(torque_Nm));
  return frame;
}

std::optional<Frame> set_input_vel(std::uint8_t node, double velocity, double torque_Nm) noexcept {
  return two_floats(node, Command::set_input_vel, velocity, torque_Nm);
}

std::optional<Frame> set_limits(std::uint8_t node, double velocity, double current_A) noexcept {
  return two_floats(node, Command::set_limits, velocity, current_A);
}

Frame clear_errors(std::uint8_t node) noexcept {
  return frame_of(node, Command::clear_errors, 1);
}
Frame estop(std::uint8_t node) noexcept {
  return frame_of(node, Command::estop, 0);
}
Frame reboot(std::uint8_t node) noexcept {
  return frame_of(node, Command::reboot, 1);
}

Frame request(std::uint8_t node, Command command) noexcept {
  Frame frame = frame_of(node, command, 8);
  frame.remote = true;
  return frame;
}

Decoded decode(const Frame& frame, std::uint8_t node) noexcept {
  if (frame.error) return {Received::error_frame, {}};
  if (frame.extended || frame.remote || frame.fd || (frame.id >> 5) != node) return {};
  const auto command = static_cast<Command>(frame.id & 0x1f);
  if (of_a_host(command)) return {Received::other_master, {}};
  if (!of_a_drive(command)) return {};
  if (frame.size < 8) return {Received::malformed, {}};
  return message_of(command, frame.payload());
}

std::string_view error_word(int bit) noexcept {
  switch (bit) {
    case 0:
      return "initializing";
    case 1:
      return "system level";
    case 2:
      return "timing error";
    case 3:
      return "missing estimate";
    case 4:
      return "bad config";
    case 5:
      return "driver fault";
    case 6:
      return "missing input";
    case 8:
      return "DC bus over-voltage";
    case 9:
      return "DC bus under-voltage";
    case 10:
      return "DC bus over-current";
    case 11:
      return "DC bus over-regeneration current";
    case 12:
      return "current limit violation";
    case 13:
      return "motor over-temperature";
    case 14:
      return "inverter over-temperature";
    case 15:
      return "velocity limit violation";
    case 16:
      return "position limit violation";
    case 24:
      return "watchdog timer expired";
    case 25:
      return "emergency stop requested";
    case 26:
      return "spinout detected";
    case 27:
      return "brake resistor disarmed";
    case 28:
      return "thermistor disconnected";
    case 30:
      return "calibration error";
    default:
      return {};
  }
}

}  // namespace hapticd::can::odrive
