#include "sim/usb/openffboard_wire.h"

namespace hapticd::sim::usb {
namespace {

void append(std::vector<std::uint8_t>& bytes, std::uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<std::uint8_t>(value >> 8 * i));
}

std::uint64_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t size) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < size && at + i < bytes.size(); ++i)
    value |= std::uint64_t{bytes[at + i]} << 8 * i;
  return value;
}

bool is_report(std::span<const std::uint8_t> bytes, OpenffboardReport report, std::size_t size) {
  return bytes.size() >= size && bytes[0] == static_cast<std::uint8_t>(report);
}

}  // namespace

std::vector<std::uint8_t> openffboard_pad(const OpenffboardPad& pad) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(OpenffboardReport::pad)};
  append(bytes, pad.buttons, 8);
  for (const std::int16_t axis : pad.axes) append(bytes, static_cast<std::uint16_t>(axis), 2);
  return bytes;
}

std::vector<std::uint8_t> openffboard_command(const OpenffboardCommand& command) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(OpenffboardReport::command),
                                  static_cast<std::uint8_t>(command.type)};
  append(bytes, command.class_id, 2);
  append(bytes, command.instance, 1);
  append(bytes, command.command, 4);
  append(bytes, static_cast<std::uint64_t>(command.data), 8);
  append(bytes, static_cast<std::uint64_t>(command.address), 8);
  return bytes;
}

std::optional<OpenffboardCommand> openffboard_command(std::span<const std::uint8_t> report) {
  if (!is_report(report, OpenffboardReport::command, kOpenffboardCommandBytes)) return std::nullopt;
  return OpenffboardCommand{.type = static_cast<OpenffboardCommand::Type>(report[1]),
                            .class_id = static_cast<std::uint16_t>(number_at(report, 2, 2)),
                            .instance = report[4],
                            .command = static_cast<std::uint32_t>(number_at(report, 5, 4)),
                            .data = static_cast<std::int64_t>(number_at(report, 9, 8)),
                            .address = static_cast<std::int64_t>(number_at(report, 17, 8))};
}

std::optional<OpenffboardSetEffect> openffboard_set_effect(std::span<const std::uint8_t> report) {
  if (!is_report(report, OpenffboardReport::set_effect, 2)) return std::nullopt;
  OpenffboardSetEffect effect{.index = report[1],
                              .type = static_cast<std::uint8_t>(number_at(report, 2, 1)),
                              .duration_ms = static_cast<std::uint16_t>(number_at(report, 3, 2)),
                              .start_delay_ms = static_cast<std::uint16_t>(number_at(report, 9, 2)),
                              .enable = static_cast<std::uint8_t>(number_at(report, 13, 1)),
                              .direction_x = static_cast<std::uint16_t>(number_at(report, 14, 2)),
                              .direction_y = static_cast<std::uint16_t>(number_at(report, 16, 2))};
  if (report.size() > 11) effect.gain = report[11];
  return effect;
}

std::optional<OpenffboardConstant> openffboard_constant(std::span<const std::uint8_t> report) {
  if (!is_report(report, OpenffboardReport::constant_force, 4)) return std::nullopt;
  return OpenffboardConstant{.index = report[1],
                             .magnitude = static_cast<std::int16_t>(number_at(report, 2, 2))};
}

std::optional<OpenffboardOperation> openffboard_operation(std::span<const std::uint8_t> report) {
  if (!is_report(report, OpenffboardReport::effect_operation, 3)) return std::nullopt;
  return OpenffboardOperation{.index = report[1], .operation = report[2]};
}

std::vector<std::uint8_t> openffboard_state(const OpenffboardState& state) {
  const int bits = (state.paused ? 1 : 0) | (state.actuators ? 2 : 0) | (state.safety ? 4 : 0) |
                   (state.power ? 8 : 0) | (state.playing ? 16 : 0);
  return {static_cast<std::uint8_t>(OpenffboardReport::state), static_cast<std::uint8_t>(bits)};
}

std::vector<std::uint8_t> openffboard_block_load(std::uint8_t index, std::uint8_t status,
                                                 std::uint16_t ram_bytes) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(OpenffboardReport::block_load), index,
                                  status};
  append(bytes, ram_bytes, 2);
  return bytes;
}

std::vector<std::uint8_t> openffboard_pool(std::uint16_t ram_bytes, std::uint8_t effects) {
  std::vector<std::uint8_t> bytes{static_cast<std::uint8_t>(OpenffboardReport::pool)};
  append(bytes, ram_bytes, 2);
  bytes.push_back(effects);
  bytes.push_back(1);  // the device manages its pool
  return bytes;
}

}  // namespace hapticd::sim::usb
