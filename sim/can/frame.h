// CAN frames as the emulated drives handle them, and numbers in their payload (little endian, as
// all three protocols have them). Nothing here is shared with drivers/can: a mistake there must not
// be made here too.
#pragma once
#include <linux/can.h>

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace hapticd::sim::can {

/// A classic frame has no CANFD_FDF in flags; ids carry CAN_EFF_FLAG / CAN_RTR_FLAG / CAN_ERR_FLAG
/// as in Linux.
using Frame = canfd_frame;

inline bool is_fd(const Frame& frame) {
  return (frame.flags & CANFD_FDF) != 0;
}
inline bool is_rtr(const Frame& frame) {
  return (frame.can_id & CAN_RTR_FLAG) != 0;
}
inline bool is_extended(const Frame& frame) {
  return (frame.can_id & CAN_EFF_FLAG) != 0;
}
inline bool is_error(const Frame& frame) {
  return (frame.can_id & CAN_ERR_FLAG) != 0;
}
/// Standard id, no FD, no error frame; may be a remote request.
inline bool is_plain(const Frame& frame) {
  return !is_fd(frame) && !is_extended(frame) && !is_error(frame);
}
/// Without the flags.
inline std::uint32_t id_of(const Frame& frame) {
  return frame.can_id & (is_extended(frame) ? CAN_EFF_MASK : CAN_SFF_MASK);
}
inline std::span<const std::uint8_t> payload(const Frame& frame) {
  return {frame.data, frame.len};
}

/// Classic frame with a standard id and zeros for data.
inline Frame classic_frame(std::uint32_t id, std::uint8_t length) {
  Frame frame{};
  frame.can_id = id;
  frame.len = length;
  return frame;
}

/// Little-endian integer or float at `at`; the caller has checked the length.
template <class T>
T get(std::span<const std::uint8_t> data, std::size_t at) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < sizeof(T); ++i) bits |= std::uint64_t{data[at + i]} << (8 * i);
  if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  } else {
    return static_cast<T>(bits);
  }
}

template <class T>
void put(Frame& frame, std::size_t at, T value) {
  std::uint64_t bits = 0;
  if constexpr (std::is_same_v<T, float>) {
    bits = std::bit_cast<std::uint32_t>(value);
  } else {
    bits = static_cast<std::uint64_t>(value);
  }
  for (std::size_t i = 0; i < sizeof(T); ++i)
    frame.data[at + i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

}  // namespace hapticd::sim::can
