// OpenFFBoard's reports, as the device reads and writes them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace hapticd::sim::usb {

enum class OpenffboardReport : std::uint8_t {
  pad = 0x01,  // in
  state = 0x02,
  set_effect = 0x01,  // out
  constant_force = 0x05,
  effect_operation = 0x0a,
  block_free = 0x0b,
  device_control = 0x0c,
  device_gain = 0x0d,
  create_effect = 0x11,  // feature
  block_load = 0x12,
  pool = 0x13,
  command = 0xa1,
};

inline constexpr std::size_t kOpenffboardPadBytes = 25, kOpenffboardCommandBytes = 25;

struct OpenffboardPad {
  std::uint64_t buttons = 0;
  std::array<std::int16_t, 8> axes{};
  bool operator==(const OpenffboardPad&) const = default;
};
std::vector<std::uint8_t> openffboard_pad(const OpenffboardPad& pad);

struct OpenffboardCommand {
  enum class Type : std::uint8_t {
    write = 0,
    read = 1,
    info = 2,
    write_at = 3,
    read_at = 4,
    ack = 10,
    not_found = 13,
    notification = 14,
    error = 15,
  };
  Type type = Type::error;
  std::uint16_t class_id = 0;
  std::uint8_t instance = 0;
  std::uint32_t command = 0;
  std::int64_t data = 0, address = 0;
  bool operator==(const OpenffboardCommand&) const = default;
};
std::vector<std::uint8_t> openffboard_command(const OpenffboardCommand& command);
/// Nothing: shorter than 25 bytes, or another report.
std::optional<OpenffboardCommand> openffboard_command(std::span<const std::uint8_t> report);

struct OpenffboardSetEffect {
  std::uint8_t index = 0, type = 0;
  std::uint16_t duration_ms = 0, start_delay_ms = 0;
  std::uint8_t gain = 255;
  std::uint8_t enable = 0;  ///< a bit an axis, then that of the direction
  std::uint16_t direction_x = 0, direction_y = 0;
};
/// The firmware copies what there is over zeros, so what is short has a direction 0.
std::optional<OpenffboardSetEffect> openffboard_set_effect(std::span<const std::uint8_t> report);

struct OpenffboardConstant {
  std::uint8_t index = 0;
  std::int16_t magnitude = 0;
};
std::optional<OpenffboardConstant> openffboard_constant(std::span<const std::uint8_t> report);

struct OpenffboardOperation {
  std::uint8_t index = 0, operation = 0;  ///< 1 start, 2 start alone, 3 stop
};
std::optional<OpenffboardOperation> openffboard_operation(std::span<const std::uint8_t> report);

struct OpenffboardState {
  bool paused = false, actuators = false, safety = false, power = false, playing = false;
};
std::vector<std::uint8_t> openffboard_state(const OpenffboardState& state);
/// `status`: 1 ok, 2 full, 3 error.
std::vector<std::uint8_t> openffboard_block_load(std::uint8_t index, std::uint8_t status,
                                                 std::uint16_t ram_bytes);
std::vector<std::uint8_t> openffboard_pool(std::uint16_t ram_bytes, std::uint8_t effects);

std::vector<std::uint8_t> openffboard_report_descriptor(std::size_t axes);

}  // namespace hapticd::sim::usb
