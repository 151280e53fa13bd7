#include "sim/can/odrive_wire.h"

#include <algorithm>

namespace hapticd::sim::can {
namespace {

constexpr double kFeedforwardStep = 0.001;  // of the int16 in Set_Input_Pos

OdriveCommand odrive_command(const Frame& frame) {
  return static_cast<OdriveCommand>(id_of(frame) & 0x1f);
}

Frame odrive_frame(std::uint8_t node, OdriveCommand what) {
  return classic_frame(static_cast<std::uint32_t>(node) << 5 | static_cast<std::uint32_t>(what), 8);
}

bool odrive_can_be_asked(OdriveCommand what) {
  constexpr std::array kGettable{OdriveCommand::get_version,
                                 OdriveCommand::get_error,
                                 OdriveCommand::get_encoder_estimates,
                                 OdriveCommand::get_iq,
                                 OdriveCommand::get_temperature,
                                 OdriveCommand::get_bus_voltage_current,
                                 OdriveCommand::get_torques,
                                 OdriveCommand::get_powers,
                                 OdriveCommand::address};
  return std::ranges::find(kGettable, what) != kGettable.end();
}

OdriveSetInputPos odrive_input_pos(std::span<const std::uint8_t> data) {
  return {get<float>(data, 0), kFeedforwardStep * get<std::int16_t>(data, 4),
          kFeedforwardStep * get<std::int16_t>(data, 6)};
}

OdriveSetAddress odrive_set_address(std::span<const std::uint8_t> data) {
  const std::uint64_t low = get<std::uint32_t>(data, 1);
  return {data[0], low | std::uint64_t{get<std::uint16_t>(data, 5)} << 32};
}

std::optional<OdriveOrder> odrive_data_order(OdriveCommand what,
                                             std::span<const std::uint8_t> data) {
  const auto has = [&](std::size_t bytes) { return data.size() >= bytes; };
  switch (what) {
    case OdriveCommand::estop:
      return OdriveEstop{};
    case OdriveCommand::set_axis_state:
      if (has(4)) return OdriveSetAxisState{get<std::uint32_t>(data, 0)};
      break;
    case OdriveCommand::set_controller_mode:
      if (has(8))
        return OdriveSetControllerMode{get<std::uint32_t>(data, 0), get<std::uint32_t>(data, 4)};
      break;
    case OdriveCommand::set_input_pos:
      if (has(8)) return odrive_input_pos(data);
      break;
    case OdriveCommand::set_input_vel:
      if (has(8)) return OdriveSetInputVel{get<float>(data, 0), get<float>(data, 4)};
      break;
    case OdriveCommand::set_input_torque:
      if (has(4)) return OdriveSetInputTorque{get<float>(data, 0)};
      break;
    case OdriveCommand::set_limits:
      if (has(8)) return OdriveSetLimits{get<float>(data, 0), get<float>(data, 4)};
      break;
    case OdriveCommand::clear_errors:
      if (has(1)) return OdriveClearErrors{data[0]};
      break;
    case OdriveCommand::reboot:
      if (has(1)) return OdriveReboot{data[0]};
      break;
    case OdriveCommand::address:
      if (has(7)) return odrive_set_address(data);
      break;
    default:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::uint8_t odrive_node(const Frame& frame) {
  return static_cast<std::uint8_t>(id_of(frame) >> 5);
}

std::optional<OdriveOrder> odrive_order(const Frame& frame) {
  if (!is_plain(frame) || frame.len > 8) return std::nullopt;
  const OdriveCommand what = odrive_command(frame);
  if ((is_rtr(frame) || frame.len == 0) && odrive_can_be_asked(what)) return OdriveAsk{what};
  if (is_rtr(frame)) return std::nullopt;
  return odrive_data_order(what, payload(frame));
}

Frame odrive_version(std::uint8_t node, const OdriveVersion& version) {
  Frame frame = odrive_frame(node, OdriveCommand::get_version);
  frame.data[0] = version.protocol;
  std::copy_n(version.hardware.begin(), 3, frame.data + 1);
  std::copy_n(version.firmware.begin(), 3, frame.data + 4);
  frame.data[7] = version.unreleased;
  return frame;
}

Frame odrive_heartbeat(std::uint8_t node, const OdriveHeartbeat& heartbeat) {
  Frame frame = odrive_frame(node, OdriveCommand::heartbeat);
  put(frame, 0, heartbeat.error);
  frame.data[4] = heartbeat.state;
  frame.data[5] = heartbeat.result;
  frame.data[6] = heartbeat.trajectory_done ? 1 : 0;
  return frame;
}

Frame odrive_error(std::uint8_t node, std::uint32_t active, std::uint32_t disarm_reason) {
  Frame frame = odrive_frame(node, OdriveCommand::get_error);
  put(frame, 0, active);
  put(frame, 4, disarm_reason);
  return frame;
}

Frame odrive_address(std::uint8_t node, std::uint64_t serial) {
  Frame frame = odrive_frame(node, OdriveCommand::address);
  frame.data[0] = node;
  put(frame, 1, static_cast<std::uint32_t>(serial));
  put(frame, 5, static_cast<std::uint16_t>(serial >> 32));
  return frame;
}

Frame odrive_floats(std::uint8_t node, OdriveCommand what, double first, double second) {
  Frame frame = odrive_frame(node, what);
  put(frame, 0, static_cast<float>(first));
  put(frame, 4, static_cast<float>(second));
  return frame;
}

}  // namespace hapticd::sim::can
