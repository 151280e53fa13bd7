// Objects of an emulated CiA 402 drive that it uses itself.
#pragma once
#include <cmath>
#include <cstdint>

#include "sim/can/cia402_objects.h"

namespace hapticd::sim::can {

inline constexpr std::uint32_t kProducerHeartbeat = object_key(0x1017),
                               kConsumerHeartbeat = object_key(0x1016, 1),
                               kErrorRegister = object_key(0x1001),
                               kAbortOption = object_key(0x6007), kErrorCode = object_key(0x603f),
                               kControlword = object_key(0x6040), kStatusword = object_key(0x6041),
                               kMode = object_key(0x6060), kModeDisplay = object_key(0x6061),
                               kPosition = object_key(0x6064), kVelocity = object_key(0x606c),
                               kTargetTorque = object_key(0x6071), kMaxTorque = object_key(0x6072),
                               kRatedTorque = object_key(0x6076), kTorque = object_key(0x6077);
inline constexpr std::uint32_t kCst = 10;
inline constexpr std::uint32_t kCstSupported = 1U << 9;

/// Rounded down, as an object has it: negative numbers in two's complement.
inline std::uint32_t cia402_whole(double value) {
  return static_cast<std::uint32_t>(static_cast<std::int64_t>(std::floor(value)));
}

}  // namespace hapticd::sim::can
