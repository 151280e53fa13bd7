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
inline constexpr std::size_t kCacheLine = 64;

}  // namespace hapticd
