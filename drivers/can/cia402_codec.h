// The part of CANopen (CiA 301) and of its drive profile (CiA 402) that cyclic torque needs: frames to bytes and back.
// Pure: no socket, no clock, no state. Classic frames, standard ids, little endian.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/can/frame.h"

namespace hapticd::can::cia402 {

inline constexpr std::uint8_t kMaxNode = 127;

// -- network

enum class Nmt : std::uint8_t {
  start = 0x01,
  stop = 0x02,
  pre_operational = 0x80,
  reset_node = 0x81,
  reset_communication = 0x82
};
/// node 0: all.
Frame nmt(Nmt command, std::uint8_t node) noexcept;
Frame sync() noexcept;
bool is_sync(const Frame& frame) noexcept;
/// A command to this node, or to all.
bool is_nmt(const Frame& frame, std::uint8_t node) noexcept;

enum class NodeState : std::uint8_t {
  boot_up = 0,
  stopped = 4,
  operational = 5,
  pre_operational = 127
};

/// What a node says of itself.
Frame heartbeat(std::uint8_t node, NodeState state) noexcept;

// -- objects, one at a time: outside the loop only

struct Object {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
};
/// `size` 1 to 4 bytes of `value`, two's complement. Nothing: another size, or a value that does not fit.
std::optional<Frame> sdo_write(std::uint8_t node, Object object, std::int64_t value,
                               int size) noexcept;
Frame sdo_read(std::uint8_t node, Object object) noexcept;

struct SdoReply {
  enum class Kind : std::uint8_t { written, read, aborted } kind = Kind::written;
  Object object{};
  std::uint32_t value = 0;  ///< read: zero-extended; aborted: the abort code
  int size = 0;             ///< of what was read, bytes
};

// -- drive

enum class State : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction,
  fault,
};
/// Of a status word.
State state_of(std::uint16_t status) noexcept;
struct StatusBits {
  bool voltage_enabled = false, warning = false, remote = false, internal_limit = false;
  bool target_followed = false;  ///< in cyclic synchronous torque
};
StatusBits bits_of(std::uint16_t status) noexcept;
/// The control word that leads one state on towards operation enabled. From a fault it is the reset, whose bit 7 has
/// to rise: send 0 before it.
std::uint16_t towards_enabled(State state) noexcept;

/// Nearest thousandth of the rated torque, saturated. Nothing: not finite, or no rated torque.
std::optional<std::int16_t> torque_raw(double torque_Nm, double rated_torque_Nm) noexcept;
/// Control word and target torque.
Frame rpdo1(std::uint8_t node, std::uint16_t control, std::int16_t torque_raw) noexcept;

// -- from the drive

struct Tpdo1 {
  std::uint16_t status = 0;
  std::int32_t position = 0;
  std::int16_t torque = 0;  ///< thousandths of the rated torque
};
struct Tpdo2 {
  std::int32_t velocity = 0;  ///< the vendor's unit
  std::uint16_t error = 0;
  std::int8_t mode = 0;
};
struct Emergency {
  std::uint16_t code = 0;  ///< 0: what was wrong is over
  std::uint8_t error_register = 0;
  std::array<std::uint8_t, 5> vendor{};
};
struct NodeGuard {
  NodeState state = NodeState::boot_up;
};

enum class Received : std::uint8_t {
  ok,
  ignore,        ///< not of this node, or nothing that is used here
  malformed,     ///< of this node, and not as long as it has to be
  other_master,  ///< to this node, and somebody else sent it
  error_frame,
};
struct Decoded {
  Received received = Received::ignore;
  // one of them, where `ok`
  std::optional<Tpdo1> tpdo1{};
  std::optional<Tpdo2> tpdo2{};
  std::optional<Emergency> emergency{};
  std::optional<NodeGuard> guard{};
  std::optional<SdoReply> sdo{};
};
Decoded decode(const Frame& frame, std::uint8_t node) noexcept;

std::string_view word_of(State state) noexcept;
std::string_view word_of(NodeState state) noexcept;
/// Of an emergency code; empty: the vendor's.
std::string_view emergency_word(std::uint16_t code) noexcept;

}  // namespace hapticd::can::cia402
