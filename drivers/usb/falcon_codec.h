// The Novint Falcon behind its FTDI bridge: packets, status bytes, what is said while firmware is loaded. Pure: no USB, no
// clock, no heap.
//
// A packet has 16 bytes each way: '<', three int16 as four nibbles each with the lowest first, a status byte, one byte
// that means nothing, '>'. Every byte but the brackets is 0x41 and a few bits, and a bracket is nowhere inside: so packets
// are found again after any loss. There is no checksum: bytes lost or put in between show by the packet's length alone, and
// where exactly a multiple of 16 was lost from the middle of one packet to the middle of another, the format cannot tell.
// Wire facts: libnifalcon (BSD).
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>

namespace hapticd::usb::falcon {

inline constexpr std::uint16_t kVendor = 0x0403, kProduct = 0xcb48;
inline constexpr std::uint8_t kBulkIn = 0x81, kBulkOut = 0x02;
inline constexpr std::size_t kPacketBytes = 16;
using Packet = std::array<std::uint8_t, kPacketBytes>;

// -- to the device

struct Command {
  /// In the device's steps, -32768 to 32767; of opposite sign to the torque of a leg.
  std::array<double, 3> motor_counts{};
  bool homing = false;  ///< the device searches its zeros while the user moves the grip
  bool green = false, blue = false, red = false;
};
struct Encoded {
  Packet packet{};
  /// What the wire carries: rounded half away from zero, then clipped to an int16.
  std::array<std::int16_t, 3> motor_counts{};
  bool saturated = false;
};
/// Nothing: a motor value is not finite.
std::optional<Encoded> encode(const Command& command) noexcept;

// -- from the device

struct Sample {
  /// Of legs 1 to 3. Their zero is unknown until the leg is homed; they wrap at 16 bits.
  std::array<std::int16_t, 3> encoder_counts{};
  std::uint8_t homed = 0;    ///< bit 0 to 2: leg 1 to 3
  std::uint8_t buttons = 0;  ///< of the grip, kPlus to kMinus
  bool operator==(const Sample&) const = default;
};
inline constexpr std::uint8_t kAllHomed = 7;
inline constexpr std::uint8_t kPlus = 1, kForward = 2, kCentre = 4, kMinus = 8;

/// Of a packet, whole and alone. Nothing: another length, a bracket amiss, or a byte that no packet has there.
std::optional<Sample> decode(std::span<const std::uint8_t> packet) noexcept;

/// Finds packets in a stream of bytes: from each '<' on 16 are looked at, and one is dropped where they are no packet.
class Deframer {
 public:
  /// The next byte of the line, without FTDI's own. A sample where it ends a packet.
  std::optional<Sample> push(std::uint8_t byte) noexcept;
  /// Forgets what was begun: bytes are known to be missing. They count as dropped, and `skipped` that never came here.
  void restart(std::size_t skipped = 0) noexcept;

  std::size_t held() const noexcept { return held_; }  ///< of what may become a packet, < 16
  std::uint64_t dropped() const noexcept { return dropped_; }  ///< bytes since the start

 private:
  void drop_to_next_begin() noexcept;  ///< at least one byte

  Packet packet_{};
  std::size_t held_ = 0;
  std::uint64_t dropped_ = 0;
};

/// FTDI: a USB packet begins with modem and line status, so a transfer has these two bytes again every 64.
inline constexpr std::size_t kUsbPacketBytes = 64, kStatusBytes = 2;
/// Line status, as a 16550 has it. The bridge lost bytes or took them wrong: overrun, parity, framing, break.
inline constexpr std::uint8_t kLineErrors = 0x02 | 0x04 | 0x08 | 0x10;

/// Samples out of bulk IN transfers.
class Receiver {
 public:
  struct Received {
    std::optional<Sample> newest{};
    int packets = 0;          ///< whole ones in this transfer
    bool line_error = false;  ///< what came with it was dropped, and what had begun before
  };
  /// `transfer`: as it completed, of any length. Two bytes alone mean "no data" and are no error.
  Received take(std::span<const std::uint8_t> transfer) noexcept;
  /// As take(), and every sample in order to `each(const Sample&)`.
  template <class Each>
  Received take_each(std::span<const std::uint8_t> transfer, Each&& each) noexcept;

  const Deframer& stream() const noexcept { return stream_; }

 private:
  /// Payload of the next USB packet, whose bytes are taken off `transfer`.
  std::span<const std::uint8_t> payload_of_next(std::span<const std::uint8_t>& transfer,
                                                bool& line_error) noexcept;
  Deframer stream_{};
};

// -- set-up and firmware: vendor requests, bmRequestType 0x40, wIndex 0, no data

struct ControlRequest {
  std::uint8_t request = 0;
  std::uint16_t value = 0;
  bool operator==(const ControlRequest&) const = default;
};
inline constexpr std::uint8_t kVendorRequestType = 0x40;
inline constexpr ControlRequest kPurgeReceived{0, 1}, kPurgeToSend{0, 2};
inline constexpr ControlRequest kRtsLow{1, 0x0200}, kDtrLow{1, 0x0100}, kDtrHigh{1, 0x0101};
inline constexpr ControlRequest kNoFlowControl{2, 0}, kEightBitsNoParity{4, 0x0008};
inline constexpr ControlRequest kBaud9600{3, 0x4138}, kBaudBoot{3, 0x0015}, kBaudRun{3, 0x0002};
inline constexpr ControlRequest kLatency1ms{9, 1}, kLatency16ms{9, 16};
/// An option of the chip that public Falcon code does not use: send on at once when a '>' has come.
inline constexpr ControlRequest kFlushOnBracket{6, 0x0100 | '>'};

/// In this order: first of all; after the greeting was answered; after the upload.
inline constexpr std::array kBeforeGreeting{
    kPurgeReceived, kPurgeToSend, kLatency16ms, kBaud9600, kEightBitsNoParity,
    kNoFlowControl, kRtsLow,      kDtrLow,      kDtrHigh};
inline constexpr std::array kBeforeUpload{kDtrLow, kBaudBoot};
inline constexpr std::array kBeforeRun{kLatency1ms, kBaudRun, kPurgeReceived, kPurgeToSend};

/// Baud of a divisor in FTDI's code: 14 bits, and eighths in the two above (0, 1/2, 1/4, 1/8). 0 and 1 are 3 and 2 Mbaud.
double baud_of(std::uint16_t divisor) noexcept;

inline constexpr std::array<std::uint8_t, 3> kGreeting{0x0a, 0x43, 0x0d};
inline constexpr std::array<std::uint8_t, 4> kGreetingAnswer{0x0a, 0x44, 0x2c, 0x0d};
inline constexpr std::array<std::uint8_t, 1> kStartUpload{0x41};  ///< is echoed

enum class Answer : std::uint8_t { incomplete, right, wrong };
/// `received`: all bytes of the line since the greeting. Zeros before the answer and any bytes after it are let pass.
Answer greeting_answer(std::span<const std::uint8_t> received) noexcept;
/// Is `received`, all bytes since, an echo of `sent`? One byte more is wrong.
Answer echo(std::span<const std::uint8_t> sent, std::span<const std::uint8_t> received) noexcept;

/// With the status bytes an echo of as many fills a USB packet, which is sent without waiting for the latency timer.
inline constexpr std::size_t kChunkBytes = 62;
/// What a firmware file may have; the public ones have 7.3 to 8.5 KB.
inline constexpr std::size_t kLeastFirmwareBytes = 1024, kMostFirmwareBytes = 65536;
/// Chunk `index` of the upload; empty: after the last.
std::span<const std::uint8_t> chunk(std::span<const std::uint8_t> firmware,
                                    std::size_t index) noexcept;

template <class Each>
Receiver::Received Receiver::take_each(std::span<const std::uint8_t> transfer,
                                       Each&& each) noexcept {
  Received received;
  while (!transfer.empty()) {
    for (const std::uint8_t byte : payload_of_next(transfer, received.line_error)) {
      const std::optional<Sample> sample = stream_.push(byte);
      if (!sample) continue;
      received.newest = sample;
      ++received.packets;
      each(*sample);
    }
  }
  return received;
}

}  // namespace hapticd::usb::falcon
