#include "sim/usb/falcon_wire.h"

namespace hapticd::sim::usb {
namespace {

constexpr std::uint8_t kFrameStart = '<', kFrameEnd = '>', kZero = 'A';

/// Four letters, the lowest nibble first; false: one is no letter of A..P.
bool nibbles(std::span<const std::uint8_t> letters, std::int16_t& value) {
  std::uint16_t bits = 0;
  for (std::size_t i = 4; i-- > 0;) {
    if (letters[i] < kZero || letters[i] > kZero + 15) return false;
    bits = static_cast<std::uint16_t>(bits << 4 | (letters[i] - kZero));
  }
  value = static_cast<std::int16_t>(bits);
  return true;
}

}  // namespace

std::optional<FalconCommand> falcon_command(std::span<const std::uint8_t> frame) {
  if (frame.size() != kFalconFrameBytes || frame[0] != kFrameStart || frame[15] != kFrameEnd)
    return std::nullopt;
  FalconCommand command;
  for (std::size_t i = 0; i < 3; ++i)
    if (!nibbles(frame.subspan(1 + 4 * i, 4), command.motors[i])) return std::nullopt;
  if (frame[13] < kZero || frame[13] > kZero + 15) return std::nullopt;
  const auto bits = static_cast<std::uint8_t>(frame[13] - kZero);
  command.homing = bits & 1;
  command.leds = bits & 14;
  return command;
}

FalconFrame falcon_reply(const FalconState& state) {
  FalconFrame frame{};
  frame[0] = kFrameStart;
  for (std::size_t i = 0; i < 12; ++i) {
    const auto bits = static_cast<std::uint16_t>(state.encoders[i / 4]);
    frame[1 + i] = static_cast<std::uint8_t>(kZero + (bits >> 4 * (i % 4) & 15));
  }
  frame[13] = static_cast<std::uint8_t>(kZero + ((state.homed & 7) << 4 | (state.grip & 15)));
  frame[14] = kZero;
  frame[15] = kFrameEnd;
  return frame;
}

std::optional<FalconCommand> FalconFrames::take(std::uint8_t byte) {
  if (byte == kFrameStart)
    filled_ = 0;
  else if (filled_ == 0 || filled_ == frame_.size())
    return std::nullopt;
  frame_[filled_++] = byte;
  if (filled_ < frame_.size()) {
    if (byte == kFrameEnd) filled_ = 0;
    return std::nullopt;
  }
  filled_ = 0;
  return falcon_command(frame_);
}

}  // namespace hapticd::sim::usb
