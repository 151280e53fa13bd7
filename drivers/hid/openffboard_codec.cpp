#include "drivers/hid/openffboard_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace hapticd::hid::openffboard {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint8_t kSetEffectReport = 0x01, kConstantForceReport = 0x05;
constexpr std::uint8_t kOperationReport = 0x0a, kControlReport = 0x0c, kGainReport = 0x0d;
constexpr std::uint8_t kConstantForceType = 1, kStart = 1, kStop = 3;

/// The caller knows that it fits.
template <class T>
T get(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <class T>
void put(std::span<std::uint8_t> bytes, std::size_t at, T value) noexcept {
  std::memcpy(bytes.data() + at, &value, sizeof value);
}

bool is(std::span<const std::uint8_t> report, std::uint8_t id, std::size_t bytes) noexcept {
  return report.size() == bytes && report[0] == id;
}

bool known(std::uint8_t type) noexcept {
  switch (static_cast<Type>(type)) {
    case Type::write:
    case Type::read:
    case Type::info:
    case Type::write_at:
    case Type::read_at:
    case Type::acknowledge:
    case Type::not_found:
    case Type::notification:
    case Type::error:
      return true;
  }
  return false;
}

bool with_address(Type type) noexcept {
  return type == Type::write_at || type == Type::read_at;
}

}  // namespace

std::optional<BlockLoad> decode_block_load(std::span<const std::uint8_t> report) noexcept {
  if (!is(report, kBlockLoadReport, 5) || report[2] < 1 || report[2] > 3) return std::nullopt;
  const auto status = static_cast<LoadStatus>(report[2]);
  if (status == LoadStatus::ok && report[1] == 0) return std::nullopt;
  return BlockLoad{report[1], status, get<std::uint16_t>(report, 3)};
}

bool encode_set_effect(const ConstantForce& force, int axes,
                       std::span<std::uint8_t> report) noexcept {
  const std::size_t least = axes == 2 ? 18 : 16;
  const bool legal = (axes == 1 || axes == 2) && report.size() >= least &&
                     report.size() <= kMostSetEffectBytes && force.effect != 0 &&
                     force.direction_centidegrees < 36000;
  if (!legal) return false;
  const auto direction_enable = static_cast<std::uint8_t>(1 << axes);
  std::fill(report.begin(), report.end(),
            std::uint8_t{0});  // repeat, sample period, delay, trigger
  report[0] = kSetEffectReport;
  report[1] = force.effect;
  report[2] = kConstantForceType;
  put(report, 3, force.duration_ms);
  report[11] = force.gain;
  report[13] = direction_enable;
  put(report, 14, force.direction_centidegrees);
  return true;
}

std::optional<Magnitude> encode_magnitude(std::uint8_t effect, double magnitude) noexcept {
  if (effect == 0 || !std::isfinite(magnitude)) return std::nullopt;
  const double counts = std::round(magnitude);
  const double clipped = std::clamp(counts, -32767.0, 32767.0);
  Magnitude encoded{.report = {kConstantForceReport, effect},
                    .magnitude = static_cast<std::int16_t>(clipped),
                    .saturated = clipped != counts};
  put(std::span<std::uint8_t>(encoded.report), 2, encoded.magnitude);
  return encoded;
}

std::array<std::uint8_t, 4> start_effect(std::uint8_t effect, std::uint8_t times) noexcept {
  return {kOperationReport, effect, kStart, times};
}
std::array<std::uint8_t, 4> stop_effect(std::uint8_t effect) noexcept {
  return {kOperationReport, effect, kStop, 0x00};
}
std::array<std::uint8_t, 2> device_control(Control control) noexcept {
  return {kControlReport, static_cast<std::uint8_t>(control)};
}
std::array<std::uint8_t, 2> device_gain(std::uint8_t gain) noexcept {
  return {kGainReport, gain};
}

std::optional<Gamepad> decode_gamepad(std::span<const std::uint8_t> report) noexcept {
  if (!is(report, kGamepadReport, kGamepadBytes)) return std::nullopt;
  Gamepad gamepad{.buttons = get<std::uint64_t>(report, 1)};
  for (std::size_t i = 0; i < gamepad.axes.size(); ++i)
    gamepad.axes[i] = get<std::int16_t>(report, 9 + 2 * i);
  return gamepad;
}

std::optional<State> decode_state(std::span<const std::uint8_t> report) noexcept {
  if (!is(report, kStateReport, 2)) return std::nullopt;
  const unsigned bits = report[1];
  return State{.paused = (bits & 1) != 0,
               .actuators_enabled = (bits & 2) != 0,
               .safety = (bits & 4) != 0,
               .power = (bits & 8) != 0,
               .playing = (bits & 16) != 0};
}

CommandReport encode(const Command& command) noexcept {
  CommandReport report{kCommandReport, static_cast<std::uint8_t>(command.type)};
  const std::span<std::uint8_t> bytes(report);
  put(bytes, 2, command.class_id);
  put(bytes, 4, command.instance);
  put(bytes, 5, command.command);
  put(bytes, 9, command.data);
  put(bytes, 17, command.address);
  return report;
}

std::optional<Command> decode_command(std::span<const std::uint8_t> report) noexcept {
  if (!is(report, kCommandReport, kCommandBytes) || !known(report[1])) return std::nullopt;
  return Command{.type = static_cast<Type>(report[1]),
                 .class_id = get<std::uint16_t>(report, 2),
                 .instance = report[4],
                 .command = get<std::uint32_t>(report, 5),
                 .data = get<std::int64_t>(report, 9),
                 .address = get<std::int64_t>(report, 17)};
}

bool answers(const Command& reply, const Command& question) noexcept {
  const bool same = reply.class_id == question.class_id && reply.command == question.command &&
                    (reply.instance == question.instance || question.instance == kAllInstances);
  if (!same) return false;
  switch (reply.type) {
    case Type::read:
      return question.type == Type::read || question.type == Type::write;
    case Type::read_at:
      return with_address(question.type) && reply.address == question.address;
    case Type::acknowledge:
    case Type::not_found:
    case Type::error:
      return true;
    default:
      return false;
  }
}

}  // namespace hapticd::hid::openffboard
