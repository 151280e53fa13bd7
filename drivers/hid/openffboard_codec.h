// OpenFFBoard: forces as HID PID constant-force effects, positions as a gamepad's, settings over its command channel. Pure:
// no HID, no clock, no heap.
//
// Reports are as on the wire, with their id as byte 0, little endian. The board has no watchdog of its own that is known:
// an effect outlives its host. So give effects a duration and set it anew, and stop them on every way out.
// Wire facts: Ultrawipf/OpenFFBoard, firmware structs and its Python client; nothing was tried on a board.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace hapticd::hid::openffboard {

inline constexpr std::uint16_t kVendor = 0x1209, kProduct = 0xffb0;
inline constexpr int kHidInterface = 2;

// -- forces: HID PID

/// Feature 0x11: a constant force; the block load report then says which effect it has become.
inline constexpr std::array<std::uint8_t, 4> kCreateConstantForce{0x11, 0x01, 0x00, 0x00};
inline constexpr std::uint8_t kBlockLoadReport = 0x12;  ///< feature

enum class LoadStatus : std::uint8_t { ok = 1, full = 2, error = 3 };
struct BlockLoad {
  std::uint8_t effect = 0;  ///< from 1 on where `ok`
  LoadStatus status = LoadStatus::error;
  std::uint16_t free_bytes = 0;
};
/// Nothing: another report, length or status, or an `ok` without effect.
std::optional<BlockLoad> decode_block_load(std::span<const std::uint8_t> report) noexcept;

inline constexpr std::uint16_t kForever = 0xffff;
inline constexpr std::size_t kMostSetEffectBytes = 64;
struct ConstantForce {
  std::uint8_t effect = 1;               ///< from 1 on
  std::uint16_t duration_ms = kForever;  ///< the effect ends by itself; 0 is for ever, too
  std::uint8_t gain = 255;
  std::uint16_t direction_centidegrees = 9000;  ///< 0 to 35999; 9000 is X
};
/// Set Effect, report 1. `report`: of the length that the report descriptor says, with the id, which depends on the build:
/// at least 16 bytes with one axis, 18 with two. False: a bad length or number of axes, effect 0, or no direction.
bool encode_set_effect(const ConstantForce& force, int axes,
                       std::span<std::uint8_t> report) noexcept;

struct Magnitude {
  std::array<std::uint8_t, 4> report{};
  std::int16_t magnitude = 0;  ///< what the wire carries
  bool saturated = false;
};
/// Set Constant Force, report 5: rounded half away from zero, then clipped to +-32767. Against the torque in sign. Nothing:
/// effect 0, or not finite.
std::optional<Magnitude> encode_magnitude(std::uint8_t effect, double magnitude) noexcept;

/// Effect Operation, report 0x0a. An effect that is started again plays on, its duration from then. The firmware does not
/// look at how often it is to be repeated (HidFFB.cpp, set_effect_operation); HID has 255 for ever.
std::array<std::uint8_t, 4> start_effect(std::uint8_t effect, std::uint8_t times = 1) noexcept;
std::array<std::uint8_t, 4> stop_effect(std::uint8_t effect) noexcept;

/// Device Control, report 0x0c. Bits here, where the HID text has an index. `reset` deletes all effects. Set Effect enables the
/// actuators, too, and makes the board tell its state, as nothing else does but creating an effect.
enum class Control : std::uint8_t {
  enable_actuators = 0x01,
  disable_actuators = 0x02,
  stop_all = 0x04,
  reset = 0x08,
  pause = 0x10,
  go_on = 0x20,
};
std::array<std::uint8_t, 2> device_control(Control control) noexcept;
/// Device Gain, report 0x0d: of 255.
std::array<std::uint8_t, 2> device_gain(std::uint8_t gain) noexcept;

// -- positions and state

/// Report 1 of a build with axes of 16 bits. Others: find() X in the report descriptor and make a map of it.
struct Gamepad {
  std::uint64_t buttons = 0;
  std::array<std::int16_t, 8>
      axes{};  ///< X Y Z RX RY RZ dial slider; X is the wheel's range over 16 bits
};
inline constexpr std::size_t kGamepadBytes = 25;
/// Nothing: another report, or of another length. No such report within 100 ms is no fault: unchanged ones are not sent.
std::optional<Gamepad> decode_gamepad(std::span<const std::uint8_t> report) noexcept;

/// Report 2.
struct State {
  bool paused = false, actuators_enabled = false, safety = false, power = false, playing = false;
  bool operator==(const State&) const = default;
};
/// Nothing: another report, or of another length.
std::optional<State> decode_state(std::span<const std::uint8_t> report) noexcept;

// -- command channel, report 0xa1. For set-up: each write is answered in the interrupt slot of a position.

inline constexpr std::uint8_t kGamepadReport = 1, kStateReport = 2, kCommandReport = 0xa1;
inline constexpr std::size_t kCommandBytes = 25;
using CommandReport = std::array<std::uint8_t, kCommandBytes>;

enum class Type : std::uint8_t {
  write = 0,
  read = 1,  ///< and the answer to it, or to a write
  info = 2,
  write_at = 3,
  read_at = 4,  ///< and the answer to it, or to a write_at
  acknowledge = 10,
  not_found = 13,
  notification = 14,
  error = 15,
};
enum class Class : std::uint16_t {
  system = 0x00,
  main = 0x01,
  axis = 0xa01,
  effects = 0xa02,         ///< the effects calculator
  effects_manager = 0xa03  ///< only in main class 3
};
/// Of class `axis`.
enum class AxisCommand : std::uint32_t {
  power = 0x00,
  degrees = 0x01,
  effect_gain = 0x02,
  zero_encoder = 0x03,
  invert = 0x04,
  idle_spring = 0x05,
  damper = 0x06,
  encoder_type = 0x07,
  driver_type = 0x08,
  position_counts = 0x09,
  max_speed = 0x0a,
  max_torque_rate = 0x0b,
  effect_ratio = 0x0c,
  current_torque = 0x0d,  ///< read only: no command sets a torque
  current_position = 0x0e,
  current_speed = 0x0f,
  current_acceleration = 0x10,
  counts_per_turn = 0x15,
  friction = 0x16,
  inertia = 0x17,
  exponent = 0x18,
};
/// Of class `main`.
enum class MainCommand : std::uint32_t {
  force_active = 0,  ///< 1: forces are on; 0: off; -1: the emergency stop is pressed
};
/// Of class `effects`.
enum class EffectsCommand : std::uint32_t {
  constant_filter_Hz = 0,  ///< low pass of constant forces; half the rate, which is the most: none
};
/// Of class `effects_manager`.
enum class ManagerCommand : std::uint32_t {
  state = 0,
  reset = 1,
  create = 2,
  type = 3,
  magnitude = 4,
  effect_state = 5
};
inline constexpr std::uint8_t kAllInstances = 0xff;

struct Command {
  Type type = Type::read;
  std::uint16_t class_id = 0;
  std::uint8_t instance = 0;
  std::uint32_t command = 0;
  std::int64_t data = 0, address = 0;
  bool operator==(const Command&) const = default;
};
CommandReport encode(const Command& command) noexcept;
/// Nothing: another report or length, or a type that is none.
std::optional<Command> decode_command(std::span<const std::uint8_t> report) noexcept;

/// Does `reply` answer `question`? Other clients' replies and notifications come the same way. That it does, says nothing of
/// how: `not_found` and `error` are answers.
bool answers(const Command& reply, const Command& question) noexcept;

}  // namespace hapticd::hid::openffboard
