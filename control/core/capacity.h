// Upper bounds of one daemon. They size stack arrays in the loop and are checked once, at compile
// of a config.
#pragma once
#include <cstddef>

namespace hapticd {

inline constexpr std::size_t kMaxDevices = 16;
inline constexpr std::size_t kMaxAxesPerDevice = 6;
inline constexpr std::size_t kMaxAxes = 48;
inline constexpr std::size_t kMaxCoordinates = 48;        ///< contact coordinates over all devices
inline constexpr std::size_t kMaxContactCoordinates = 3;  ///< of one contact
inline constexpr std::size_t kMaxObjects = 100'000;       ///< scene objects
/// Numbers that one group of contacts remembers of its coupling, or of its networks.
inline constexpr std::size_t kMaxGroupStates = 96;
inline constexpr std::size_t kMaxJoints = kMaxAxesPerDevice;  ///< of one serial chain
inline constexpr std::size_t kMaxWindow = 32;      ///< samples that a velocity estimator looks at
inline constexpr std::size_t kMaxDelayTicks = 14;  ///< whole ticks from command to force
inline constexpr std::size_t kCacheLine = 64;

}  // namespace hapticd
