// The Falcon's bytes, as the device reads and writes them.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

namespace hapticd::sim::usb {

inline constexpr std::size_t kFalconFrameBytes = 16;
using FalconFrame = std::array<std::uint8_t, kFalconFrameBytes>;

struct FalconCommand {
  std::array<std::int16_t, 3> motors{};
  std::uint8_t leds = 0;  ///< 2 green, 4 blue, 8 red
  bool homing = false;
};

struct FalconState {
  std::array<std::int16_t, 3> encoders{};
  std::uint8_t homed = 0;  ///< bit i: encoder i
  std::uint8_t grip = 0;   ///< 1 plus, 2 forward, 4 centre, 8 minus
};

/// Nothing: not a frame of 16 bytes, or a byte in it out of range.
std::optional<FalconCommand> falcon_command(std::span<const std::uint8_t> frame);
FalconFrame falcon_reply(const FalconState& state);

/// Finds frames in what comes over the line: '<' starts one, wherever it is.
class FalconFrames {
 public:
  std::optional<FalconCommand> take(std::uint8_t byte);

 private:
  FalconFrame frame_{};
  std::size_t filled_ = 0;
};

}  // namespace hapticd::sim::usb
