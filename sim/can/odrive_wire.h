// ODrive CANSimple of firmware 0.6: what goes over the wire, as the drive sees it. The id is
// node << 5 | command; units are turns, turns/s, N m, A, V, degC.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <variant>

#include "sim/can/frame.h"

namespace hapticd::sim::can {

enum class OdriveCommand : std::uint8_t {
  get_version = 0x00,
  heartbeat = 0x01,
  estop = 0x02,
  get_error = 0x03,
  address = 0x06,
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
  get_powers = 0x1d,
};

inline constexpr std::uint8_t kOdriveBroadcast = 63;

// -- host to drive

struct OdriveSetAxisState {
  std::uint32_t state = 0;
};
struct OdriveSetControllerMode {
  std::uint32_t control = 0, input = 0;
};
struct OdriveSetInputPos {
  double turns = 0, turns_s = 0, torque_Nm = 0;
};
struct OdriveSetInputVel {
  double turns_s = 0, torque_Nm = 0;
};
struct OdriveSetInputTorque {
  double torque_Nm = 0;
};
struct OdriveSetLimits {
  double velocity_turns_s = 0, current_A = 0;
};
struct OdriveClearErrors {
  std::uint8_t identify = 0;
};
struct OdriveEstop {};
struct OdriveReboot {
  std::uint8_t action = 0;
};
struct OdriveSetAddress {
  std::uint8_t node = 0;
  std::uint64_t serial = 0;  ///< 48 bits
};
/// A remote request, or an empty data frame, for a message that the drive sends.
struct OdriveAsk {
  OdriveCommand what{};
};
using OdriveOrder =
    std::variant<OdriveSetAxisState, OdriveSetControllerMode, OdriveSetInputPos, OdriveSetInputVel,
                 OdriveSetInputTorque, OdriveSetLimits, OdriveClearErrors, OdriveEstop,
                 OdriveReboot, OdriveSetAddress, OdriveAsk>;

std::uint8_t odrive_node(const Frame& frame);
/// Nothing: no CANSimple frame for a drive, too short, or a command that the emulation leaves out.
std::optional<OdriveOrder> odrive_order(const Frame& frame);

// -- drive to host

struct OdriveVersion {
  std::uint8_t protocol = 2;
  std::array<std::uint8_t, 3> hardware{4, 4, 58};
  std::array<std::uint8_t, 3> firmware{0, 6, 11};
  std::uint8_t unreleased = 0;
};
struct OdriveHeartbeat {
  std::uint32_t error = 0;
  std::uint8_t state = 0;
  std::uint8_t result = 0;
  bool trajectory_done = false;
};

Frame odrive_version(std::uint8_t node, const OdriveVersion& version);
Frame odrive_heartbeat(std::uint8_t node, const OdriveHeartbeat& heartbeat);
Frame odrive_error(std::uint8_t node, std::uint32_t active, std::uint32_t disarm_reason);
Frame odrive_address(std::uint8_t node, std::uint64_t serial);
/// All other messages are two floats.
Frame odrive_floats(std::uint8_t node, OdriveCommand what, double first, double second);

}  // namespace hapticd::sim::can
