#include "sim/can/cia402_wire.h"

#include <algorithm>
#include <cmath>

namespace hapticd::sim::can {
namespace {

// Expedited transfers: command, "expedited and size said", and how many of 4 bytes are unused.
std::uint8_t sdo_unused(std::uint8_t size) {
  return static_cast<std::uint8_t>((4 - size) << 2);
}

Frame sdo_reply(std::uint8_t node, std::uint8_t command, std::uint16_t index, std::uint8_t sub) {
  Frame frame = classic_frame(kCanopenSdoReply + node, 8);
  frame.data[0] = command;
  put(frame, 1, index);
  frame.data[3] = sub;
  return frame;
}

std::uint16_t cia402_state_bits(Cia402State state) {
  switch (state) {
    case Cia402State::not_ready:
      return 0x00;
    case Cia402State::switch_on_disabled:
      return 0x40;
    case Cia402State::ready_to_switch_on:
      return 0x21;
    case Cia402State::switched_on:
      return 0x23;
    case Cia402State::operation_enabled:
      return 0x27;
    case Cia402State::quick_stop_active:
      return 0x07;
    case Cia402State::fault_reaction:
      return 0x0f;
    default:
      return 0x08;
  }
}

}  // namespace

std::optional<NmtCommand> nmt_command(const Frame& frame, std::uint8_t node) {
  if (!is_plain(frame) || is_rtr(frame) || id_of(frame) != kCanopenNmt || frame.len != 2)
    return std::nullopt;
  if (frame.data[1] != 0 && frame.data[1] != node) return std::nullopt;
  return static_cast<NmtCommand>(frame.data[0]);
}

Frame canopen_heartbeat(std::uint8_t node, NmtState state) {
  Frame frame = classic_frame(kCanopenHeartbeat + node, 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

std::optional<SdoRequest> sdo_request(const Frame& frame, std::uint8_t node) {
  if (!is_plain(frame) || is_rtr(frame) || id_of(frame) != kCanopenSdoRequest + node ||
      frame.len != 8)
    return std::nullopt;
  const auto data = payload(frame);
  SdoRequest request{.index = get<std::uint16_t>(data, 1), .sub = data[3]};
  const std::uint8_t command = data[0];
  if (command == 0x40) request.kind = SdoRequest::Kind::read;
  if ((command & 0xe2) != 0x22) return request;  // a write, expedited
  request.kind = SdoRequest::Kind::write;
  request.value = get<std::uint32_t>(data, 4);
  if ((command & 1) == 0) return request;
  request.size = static_cast<std::uint8_t>(4 - ((command >> 2) & 3));
  request.value &= 0xffffffffU >> (8 * (4 - request.size));
  return request;
}

Frame sdo_written(std::uint8_t node, std::uint16_t index, std::uint8_t sub) {
  return sdo_reply(node, 0x60, index, sub);
}

Frame sdo_value(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                std::uint8_t size) {
  Frame frame = sdo_reply(node, static_cast<std::uint8_t>(0x43 | sdo_unused(size)), index, sub);
  put(frame, 4, value);
  return frame;
}

Frame sdo_abort(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t code) {
  Frame frame = sdo_reply(node, 0x80, index, sub);
  put(frame, 4, code);
  return frame;
}

Frame canopen_emcy(std::uint8_t node, std::uint16_t code, std::uint8_t error_register) {
  Frame frame = classic_frame(kCanopenEmcy + node, 8);
  put(frame, 0, code);
  frame.data[2] = error_register;
  return frame;
}

std::size_t pdo_put(Frame& frame, std::size_t bits, std::uint32_t value, std::size_t size_bits) {
  for (std::size_t done = 0; done < size_bits; done += 8, value >>= 8)
    frame.data[(bits + done) / 8] = static_cast<std::uint8_t>(value);
  frame.len = static_cast<std::uint8_t>((bits + size_bits) / 8);
  return bits + size_bits;
}

std::uint32_t pdo_get(const Frame& frame, std::size_t bits, std::size_t size_bits) {
  std::uint32_t value = 0;
  for (std::size_t done = 0; done < size_bits; done += 8)
    value |= static_cast<std::uint32_t>(frame.data[(bits + done) / 8]) << done;
  return value;
}

// CiA 402-2, table "command coding". Quick stop ends with the voltage off only when told so.
Cia402State cia402_next(Cia402State state, std::uint16_t control, std::uint16_t before) {
  using enum Cia402State;
  if (state == fault)
    return (control & 0x80) != 0 && (before & 0x80) == 0 ? switch_on_disabled : fault;
  if (state == not_ready || state == fault_reaction) return state;
  if ((control & 0x02) == 0) return switch_on_disabled;  // disable voltage
  if (state == quick_stop_active) return state;
  if ((control & 0x04) == 0)  // quick stop
    return state == operation_enabled ? quick_stop_active : switch_on_disabled;
  if ((control & 0x01) == 0) return ready_to_switch_on;  // shutdown
  if (state == switch_on_disabled) return state;
  if ((control & 0x08) == 0 || state == ready_to_switch_on) return switched_on;
  return operation_enabled;
}

std::uint16_t cia402_statusword(const Cia402Status& status) {
  unsigned word = cia402_state_bits(status.state) | 0x210U;
  if (status.internal_limit) word |= 0x800;
  if (status.target_followed) word |= 0x1000;
  return static_cast<std::uint16_t>(word);
}

std::int16_t cia402_per_mille(double torque_Nm, double rated_Nm) {
  const double per_mille = std::round(1000 * torque_Nm / rated_Nm);
  return static_cast<std::int16_t>(std::clamp(per_mille, -32768.0, 32767.0));
}

}  // namespace hapticd::sim::can
