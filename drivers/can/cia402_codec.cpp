#include "drivers/can/cia402_codec.h"

#include <algorithm>
#include <cmath>

namespace hapticd::can::cia402 {
namespace {

// Function codes: ids are these plus the node.
constexpr std::uint32_t kSync = 0x080, kEmergency = 0x080, kTpdo1 = 0x180, kRpdo1 = 0x200,
                        kTpdo2 = 0x280;
constexpr std::uint32_t kSdoReply = 0x580, kSdoRequest = 0x600, kGuard = 0x700;

constexpr std::uint8_t kSdoRead = 0x40, kSdoWritten = 0x60, kSdoAborted = 0x80;
/// Expedited, with its size: how many of the four bytes are none is in bits 2 and 3.
constexpr std::uint8_t kSdoWrite = 0x23, kSdoValue = 0x43;

Frame frame_of(std::uint32_t id, std::size_t size) noexcept {
  Frame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(size);
  return frame;
}

void put_object(Frame& frame, Object object) noexcept {
  put(frame, 1, object.index);
  put(frame, 3, object.sub);
}

std::uint8_t unused(int size) noexcept {
  return static_cast<std::uint8_t>((4 - size) << 2);
}

bool fits(std::int64_t value, int size) noexcept {
  const std::int64_t span = std::int64_t{1} << (8 * size);
  return value >= -span / 2 && value < span;
}

Decoded sdo_reply(std::span<const std::uint8_t> b) noexcept {
  SdoReply reply{.object = {get<std::uint16_t>(b, 1), b[3]}, .value = get<std::uint32_t>(b, 4)};
  const int size = 4 - ((b[0] >> 2) & 3);
  if (b[0] == kSdoWritten) {
    reply.kind = SdoReply::Kind::written;
  } else if (b[0] == kSdoAborted) {
    reply.kind = SdoReply::Kind::aborted;
  } else if ((b[0] & 0xf3) == kSdoValue) {
    reply.kind = SdoReply::Kind::read;
    reply.size = size;
    if (size < 4) reply.value &= (std::uint32_t{1} << (8 * size)) - 1;
  } else {
    return {};  // segmented, or of no use here
  }
  return {.received = Received::ok, .sdo = reply};
}

Emergency emergency_of(std::span<const std::uint8_t> b) noexcept {
  Emergency emergency{.code = get<std::uint16_t>(b, 0), .error_register = b[2]};
  std::copy_n(b.begin() + 3, emergency.vendor.size(), emergency.vendor.begin());
  return emergency;
}

}  // namespace

Frame nmt(Nmt command, std::uint8_t node) noexcept {
  Frame frame = frame_of(0, 2);
  frame.data[0] = static_cast<std::uint8_t>(command);
  frame.data[1] = node;
  return frame;
}

Frame sync() noexcept {
  return frame_of(kSync, 0);
}

std::optional<Frame> sdo_write(std::uint8_t node, Object object, std::int64_t value,
                               int size) noexcept {
  if (size < 1 || size > 4 || !fits(value, size)) return std::nullopt;
  Frame frame = frame_of(kSdoRequest + node, 8);
  frame.data[0] = static_cast<std::uint8_t>(kSdoWrite | unused(size));
  put_object(frame, object);
  for (int i = 0; i < size; ++i)
    frame.data[static_cast<std::size_t>(4 + i)] =
        static_cast<std::uint8_t>((value >> (8 * i)) & 0xff);
  return frame;
}

Frame sdo_read(std::uint8_t node, Object object) noexcept {
  Frame frame = frame_of(kSdoRequest + node, 8);
  frame.data[0] = kSdoRead;
  put_object(frame, object);
  return frame;
}

State state_of(std::uint16_t status) noexcept {
  switch (status & 0x4f) {
    case 0x00:
      return State::not_ready;
    case 0x40:
      return State::switch_on_disabled;
    case 0x08:
      return State::fault;
    case 0x0f:
      return State::fault_reaction;
    default:
      break;
  }
  switch (status & 0x6f) {
    case 0x21:
      return State::ready_to_switch_on;
    case 0x23:
      return State::switched_on;
    case 0x27:
      return State::operation_enabled;
    case 0x07:
      return State::quick_stop_active;
    default:
      return State::not_ready;
  }
}

StatusBits bits_of(std::uint16_t status) noexcept {
  const auto bit = [&](int i) { return ((status >> i) & 1) != 0; };
  return {.voltage_enabled = bit(4),
          .warning = bit(7),
          .remote = bit(9),
          .internal_limit = bit(11),
          .target_followed = bit(12)};
}

std::uint16_t towards_enabled(State state) noexcept {
  constexpr std::uint16_t kDisableVoltage = 0x00, kShutdown = 0x06, kSwitchOn = 0x07,
                          kEnable = 0x0f, kReset = 0x80;
  switch (state) {
    case State::switch_on_disabled:
      return kShutdown;
    case State::ready_to_switch_on:
      return kSwitchOn;
    case State::switched_on:
    case State::operation_enabled:
      return kEnable;
    case State::fault:
      return kReset;
    case State::not_ready:
    case State::quick_stop_active:
    case State::fault_reaction:
      break;
  }
  return kDisableVoltage;
}

std::optional<std::int16_t> torque_raw(double torque_Nm, double rated_torque_Nm) noexcept {
  if (!std::isfinite(torque_Nm) || !(rated_torque_Nm > 0)) return std::nullopt;
  const double raw = std::round(1000 * torque_Nm / rated_torque_Nm);
  if (std::isnan(raw)) return std::nullopt;  // both beyond all bounds
  return static_cast<std::int16_t>(std::clamp(raw, -32768.0, 32767.0));
}

Frame heartbeat(std::uint8_t node, NodeState state) noexcept {
  Frame frame = frame_of(kGuard + node, 1);
  frame.data[0] = static_cast<std::uint8_t>(state);
  return frame;
}

bool is_sync(const Frame& frame) noexcept {
  return frame.id == kEmergency && !frame.extended && !frame.remote && !frame.fd && !frame.error;
}

bool is_nmt(const Frame& frame, std::uint8_t node) noexcept {
  return frame.id == 0 && !frame.extended && !frame.remote && !frame.fd && !frame.error &&
         frame.size >= 2 && (frame.data[1] == 0 || frame.data[1] == node);
}

Frame rpdo1(std::uint8_t node, std::uint16_t control, std::int16_t torque_raw) noexcept {
  Frame frame = frame_of(kRpdo1 + node, 4);
  put(frame, 0, control);
  put(frame, 2, torque_raw);
  return frame;
}

Decoded decode(const Frame& frame, std::uint8_t node) noexcept {
  if (frame.error) return {.received = Received::error_frame};
  if (frame.extended || frame.remote || frame.fd || (frame.id & 0x7f) != node) return {};
  const std::span<const std::uint8_t> b = frame.payload();
  const auto as_long_as = [&](std::size_t size) { return b.size() >= size; };
  constexpr Decoded kMalformed{.received = Received::malformed};
  switch (frame.id - node) {
    case kTpdo1:
      if (!as_long_as(8)) return kMalformed;
      return {.received = Received::ok,
              .tpdo1 = Tpdo1{get<std::uint16_t>(b, 0), get<std::int32_t>(b, 2),
                             get<std::int16_t>(b, 6)}};
    case kTpdo2:
      if (!as_long_as(7)) return kMalformed;
      return {.received = Received::ok,
              .tpdo2 = Tpdo2{get<std::int32_t>(b, 0), get<std::uint16_t>(b, 4),
                             static_cast<std::int8_t>(b[6])}};
    case kEmergency:
      if (!as_long_as(8)) return kMalformed;
      return {.received = Received::ok, .emergency = emergency_of(b)};
    case kGuard:
      if (!as_long_as(1)) return kMalformed;
      return {.received = Received::ok, .guard = NodeGuard{static_cast<NodeState>(b[0] & 0x7f)}};
    case kSdoReply:
      return as_long_as(8) ? sdo_reply(b) : kMalformed;
    case kRpdo1:
    case kSdoRequest:
      return {.received = Received::other_master};
    default:
      return {};
  }
}

std::string_view word_of(State state) noexcept {
  switch (state) {
    case State::not_ready:
      return "not ready to switch on";
    case State::switch_on_disabled:
      return "switch on disabled";
    case State::ready_to_switch_on:
      return "ready to switch on";
    case State::switched_on:
      return "switched on";
    case State::operation_enabled:
      return "operation enabled";
    case State::quick_stop_active:
      return "quick stop active";
    case State::fault_reaction:
      return "fault reaction active";
    case State::fault:
      return "fault";
  }
  return {};
}

std::string_view word_of(NodeState state) noexcept {
  switch (state) {
    case NodeState::boot_up:
      return "boot-up";
    case NodeState::stopped:
      return "stopped";
    case NodeState::operational:
      return "operational";
    case NodeState::pre_operational:
      return "pre-operational";
  }
  return "unknown";
}

std::string_view emergency_word(std::uint16_t code) noexcept {
  switch (code) {
    case 0x0000:
      return "no error any more";
    case 0x3210:
      return "DC link over-voltage";
    case 0x3220:
      return "DC link under-voltage";
    case 0x8110:
      return "CAN overrun";
    case 0x8120:
      return "CAN error passive";
    case 0x8130:
      return "heartbeat of the host lost";
    case 0x8140:
      return "recovered from bus-off";
    default:
      return {};
  }
}

}  // namespace hapticd::can::cia402
