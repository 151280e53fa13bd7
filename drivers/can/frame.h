// A CAN frame as the codecs see it: plain data, whatever carries it. Classic and FD, standard and extended.
#pragma once
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>

namespace hapticd::can {

struct Frame {
  std::uint32_t id = 0;  ///< 11 or 29 bits, without flags
  bool extended = false;
  bool remote =
      false;  ///< asks for a frame of this id; `size` is what it asks for, there is no data
  bool error = false;  ///< of the controller, not from the bus
  bool fd = false;
  bool fast = false;  ///< FD: data at the higher bit rate
  std::uint8_t size = 0;
  std::array<std::uint8_t, 64> data{};

  std::span<const std::uint8_t> payload() const noexcept {
    return {data.data(), remote ? std::size_t{0} : std::size_t{size}};
  }
  bool operator==(const Frame&) const = default;
};

/// Little endian, at `at`; the caller knows that it fits.
template <class T>
T get(std::span<const std::uint8_t> bytes, std::size_t at) noexcept {
  static_assert(std::endian::native == std::endian::little);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}
template <class T>
void put(Frame& frame, std::size_t at, T value) noexcept {
  static_assert(std::endian::native == std::endian::little);
  std::memcpy(frame.data.data() + at, &value, sizeof value);
}

/// Lengths that an FD frame may have: the least that holds `size` bytes, at most 64.
constexpr std::uint8_t fd_length(std::size_t size) noexcept {
  constexpr std::array<std::uint8_t, 8> kLengths{12, 16, 20, 24, 32, 48, 64, 64};
  if (size <= 8) return static_cast<std::uint8_t>(size);
  for (const std::uint8_t length : kLengths)
    if (size <= length) return length;
  return 64;
}

}  // namespace hapticd::can
