// CANopen as a CiA 402 drive sees it: bytes of NMT, SDO, PDO, EMCY and heartbeat, and the words of
// the state machine. Identifiers as in CiA 301's predefined connection set.
#pragma once
#include <cstdint>
#include <optional>
#include <span>

#include "sim/can/frame.h"

namespace hapticd::sim::can {

// -- identifiers

inline constexpr std::uint32_t kCanopenNmt = 0x000, kCanopenSync = 0x080, kCanopenEmcy = 0x080,
                               kCanopenSdoReply = 0x580, kCanopenSdoRequest = 0x600,
                               kCanopenHeartbeat = 0x700;

// -- NMT and heartbeat

enum class NmtCommand : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82,
};
enum class NmtState : std::uint8_t {
  boot_up = 0,
  stopped = 4,
  operational = 5,
  pre_operational = 127,
};
/// For `node` or for all; nothing: another frame, or for somebody else.
std::optional<NmtCommand> nmt_command(const Frame& frame, std::uint8_t node);
Frame canopen_heartbeat(std::uint8_t node, NmtState state);

// -- SDO

struct SdoRequest {
  enum class Kind : std::uint8_t { read, write, other };
  Kind kind = Kind::other;
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint32_t value = 0;
  std::uint8_t size = 0;  ///< of a write; 0: it does not say
};
/// Nothing: no SDO request to `node`.
std::optional<SdoRequest> sdo_request(const Frame& frame, std::uint8_t node);
Frame sdo_written(std::uint8_t node, std::uint16_t index, std::uint8_t sub);
Frame sdo_value(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t value,
                std::uint8_t size);
Frame sdo_abort(std::uint8_t node, std::uint16_t index, std::uint8_t sub, std::uint32_t code);

/// Abort codes of CiA 301.
namespace sdo {
inline constexpr std::uint32_t kUnknownCommand = 0x05040001, kReadOnly = 0x06010002,
                               kNoObject = 0x06020000, kNotMappable = 0x06040041,
                               kTooManyMapped = 0x06040042, kTooLong = 0x06070012,
                               kTooShort = 0x06070013, kNoSubIndex = 0x06090011,
                               kValueRange = 0x06090030, kWrongState = 0x08000022;
}  // namespace sdo

// -- EMCY

Frame canopen_emcy(std::uint8_t node, std::uint16_t code, std::uint8_t error_register);

// -- PDO

/// Packs one mapped value into a frame behind the `bits` that it has; returns those after it.
std::size_t pdo_put(Frame& frame, std::size_t bits, std::uint32_t value, std::size_t size_bits);
std::uint32_t pdo_get(const Frame& frame, std::size_t bits, std::size_t size_bits);

// -- state machine

enum class Cia402State : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction,
  fault,
};
/// After a control word; `before`: the last one, for the edge that resets a fault.
Cia402State cia402_next(Cia402State state, std::uint16_t control, std::uint16_t before);

struct Cia402Status {
  Cia402State state{};
  bool internal_limit = false;   ///< bit 11
  bool target_followed = false;  ///< bit 12, in CST
};
/// Power supply and remote control are always there: bits 4 and 9.
std::uint16_t cia402_statusword(const Cia402Status& status);

/// Per mille of rated torque, to the nearest.
std::int16_t cia402_per_mille(double torque_Nm, double rated_Nm);

}  // namespace hapticd::sim::can
