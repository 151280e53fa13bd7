// What a fuzz case is made of: its bytes, taken from the front, and the check that ends a run.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <span>

#include "drivers/can/frame.h"

namespace hapticd::fuzz {

/// Traps where what must hold does not: libFuzzer then keeps the input.
inline void must(bool holds, const char* what, const char* file = __builtin_FILE(),
                 int line = __builtin_LINE()) {
  if (holds) return;
  std::fprintf(stderr, "%s:%d: does not hold: %s\n", file, line, what);
  __builtin_trap();
}

/// Zeros once the bytes are used up.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : rest_(data, size) {}

  bool empty() const { return rest_.empty(); }
  template <class T>
  T take() {
    T value{};
    const std::size_t count = std::min(sizeof value, rest_.size());
    std::memcpy(&value, rest_.data(), count);
    rest_ = rest_.subspan(count);
    return value;
  }
  std::uint8_t byte() { return take<std::uint8_t>(); }
  /// Any double, those at the edges often.
  double number() {
    const std::uint8_t kind = byte();
    const double sign = (kind & 0x80) != 0 ? -1 : 1;
    switch (kind & 7) {
      case 0:
        return sign * std::numeric_limits<double>::quiet_NaN();
      case 1:
        return sign * std::numeric_limits<double>::infinity();
      case 2:
        return take<double>();
      case 3:
        return static_cast<double>(take<float>());
      case 4:  // about the largest single
        return sign * (double{std::numeric_limits<float>::max()} + std::ldexp(byte(), 100) -
                       std::ldexp(128, 100));
      default:
        return sign * std::ldexp(take<std::uint16_t>(), -(byte() % 40));
    }
  }

 private:
  std::span<const std::uint8_t> rest_;
};

inline constexpr std::uint8_t kExtended = 1, kRemote = 2, kError = 4, kFd = 8, kFast = 16;
/// Of the flags' highest three bits: the id as it is, one of the node's own with these flags; else
/// such a one without.
inline constexpr std::uint8_t kRawId = 0, kOwnId = 3;

/// Whatever the kernel may hand over. `own(frame, number)`: gives it one of the node's ids, and
/// that protocol's kind.
template <class Own>
can::Frame frame_of(Input& input, const Own& own) {
  can::Frame frame;
  const std::uint8_t flags = input.byte();
  const auto id = input.take<std::uint32_t>();
  const std::uint8_t size = input.byte();
  if (flags >> 5 != kRawId) own(frame, id);
  if (flags >> 5 <= kOwnId) {
    frame.extended = (flags & kExtended) != 0;
    frame.remote = (flags & kRemote) != 0;
    frame.error = (flags & kError) != 0;
    frame.fd = (flags & kFd) != 0 && !frame.remote;
    frame.fast = frame.fd && (flags & kFast) != 0;
  }
  if (flags >> 5 == kRawId) frame.id = id;
  frame.id &= frame.extended || frame.error ? 0x1fffffffu : 0x7ffu;
  frame.size = std::min<std::uint8_t>(size, frame.fd ? 64 : 8);
  for (std::size_t i = 0; i < frame.payload().size(); ++i) frame.data[i] = input.byte();
  return frame;
}

/// What goes out must be a frame that the kernel takes.
inline void must_be_legal(const can::Frame& frame) {
  must(frame.id <= (frame.extended ? 0x1fffffffu : 0x7ffu), "an id has 11 or 29 bits");
  must(!frame.error, "nobody sends error frames");
  must(frame.fd || !frame.fast, "only FD frames have a fast part");
  must(!(frame.fd && frame.remote), "FD has no remote frames");
  must(frame.fd ? frame.size == can::fd_length(frame.size) : frame.size <= 8, "a legal length");
}

/// The nearest single.
inline bool is_nearest(double found, double wanted) {
  return std::isfinite(found) && found == static_cast<double>(static_cast<float>(wanted));
}
inline bool is_single(double value) {
  return std::isfinite(value) && std::abs(value) <= double{std::numeric_limits<float>::max()};
}

}  // namespace hapticd::fuzz
