#include "drivers/usb/falcon_codec.h"

#include <algorithm>
#include <cmath>

namespace hapticd::usb::falcon {
namespace {

constexpr std::uint8_t kBegin = '<', kEnd = '>', kZero = 'A';
constexpr std::size_t kStatusAt = 13, kUnusedAt = 14, kEndAt = 15;
constexpr std::uint8_t kHighestStatus = 0xc0;

/// May a packet of the device have this byte there? A bracket only at its own end.
constexpr bool legal(std::size_t at, std::uint8_t byte) noexcept {
  if (at == 0) return byte == kBegin;
  if (at == kEndAt) return byte == kEnd;
  if (at == kStatusAt) return byte >= kZero && byte <= kHighestStatus;
  if (at == kUnusedAt) return byte != kBegin && byte != kEnd;
  return byte >= kZero && byte <= kZero + 15;
}

void put_nibbles(Packet& packet, std::size_t at, std::int16_t value) noexcept {
  const auto bits = static_cast<std::uint16_t>(value);
  for (std::size_t i = 0; i < 4; ++i)
    packet[at + i] = static_cast<std::uint8_t>(kZero + ((bits >> (4 * i)) & 15));
}

std::int16_t nibbles_at(const std::uint8_t* first) noexcept {
  unsigned bits = 0;
  for (std::size_t i = 0; i < 4; ++i) bits |= static_cast<unsigned>(first[i] - kZero) << (4 * i);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(bits));
}

Sample sample_of(const std::uint8_t* packet) noexcept {
  Sample sample;
  for (std::size_t leg = 0; leg < 3; ++leg)
    sample.encoder_counts[leg] = nibbles_at(packet + 1 + 4 * leg);
  const int status = packet[kStatusAt] - kZero;
  sample.homed = static_cast<std::uint8_t>(status >> 4);
  sample.buttons = static_cast<std::uint8_t>(status & 15);
  return sample;
}

Answer starts_as(std::span<const std::uint8_t> received,
                 std::span<const std::uint8_t> expected) noexcept {
  const std::size_t both = std::min(received.size(), expected.size());
  if (!std::equal(received.begin(), received.begin() + static_cast<std::ptrdiff_t>(both),
                  expected.begin()))
    return Answer::wrong;
  return received.size() < expected.size() ? Answer::incomplete : Answer::right;
}

}  // namespace

std::optional<Encoded> encode(const Command& command) noexcept {
  Encoded encoded;
  encoded.packet.fill(kZero);
  encoded.packet.front() = kBegin;
  encoded.packet.back() = kEnd;
  for (std::size_t leg = 0; leg < 3; ++leg) {
    if (!std::isfinite(command.motor_counts[leg])) return std::nullopt;
    const double counts = std::round(command.motor_counts[leg]);
    const double clipped = std::clamp(counts, -32768.0, 32767.0);
    encoded.saturated |= clipped != counts;
    encoded.motor_counts[leg] = static_cast<std::int16_t>(clipped);
    put_nibbles(encoded.packet, 1 + 4 * leg, encoded.motor_counts[leg]);
  }
  const int lights = (command.green ? 2 : 0) | (command.blue ? 4 : 0) | (command.red ? 8 : 0);
  encoded.packet[kStatusAt] =
      static_cast<std::uint8_t>(kZero + (lights | (command.homing ? 1 : 0)));
  return encoded;
}

std::optional<Sample> decode(std::span<const std::uint8_t> packet) noexcept {
  if (packet.size() != kPacketBytes) return std::nullopt;
  for (std::size_t at = 0; at < kPacketBytes; ++at)
    if (!legal(at, packet[at])) return std::nullopt;
  return sample_of(packet.data());
}

std::optional<Sample> Deframer::push(std::uint8_t byte) noexcept {
  packet_[held_++] = byte;
  std::optional<Sample> sample;
  if (held_ == kPacketBytes && (sample = decode(packet_))) held_ = 0;
  // Not a packet, though there are 16 bytes; or no beginning of one.
  if (held_ == kPacketBytes || (held_ == 1 && byte != kBegin)) drop_to_next_begin();
  return sample;
}

void Deframer::drop_to_next_begin() noexcept {
  const auto end = packet_.begin() + static_cast<std::ptrdiff_t>(held_);
  const auto next = std::find(packet_.begin() + 1, end, kBegin);
  const std::size_t gone = static_cast<std::size_t>(next - packet_.begin());
  std::copy(next, end, packet_.begin());
  held_ -= gone;
  dropped_ += gone;
}

void Deframer::restart(std::size_t skipped) noexcept {
  dropped_ += held_ + skipped;
  held_ = 0;
}

Receiver::Received Receiver::take(std::span<const std::uint8_t> transfer) noexcept {
  return take_each(transfer, [](const Sample&) {});
}

std::span<const std::uint8_t> Receiver::payload_of_next(std::span<const std::uint8_t>& transfer,
                                                        bool& line_error) noexcept {
  const auto packet = transfer.first(std::min(transfer.size(), kUsbPacketBytes));
  transfer = transfer.subspan(packet.size());
  if (packet.size() < kStatusBytes) return {};
  if ((packet[1] & kLineErrors) == 0) return packet.subspan(kStatusBytes);
  line_error = true;
  stream_.restart(packet.size() - kStatusBytes);
  return {};
}

double baud_of(std::uint16_t divisor) noexcept {
  constexpr std::array<double, 4> kParts{0, 0.5, 0.25, 0.125};
  if (divisor == 0) return 3e6;
  if (divisor == 1) return 2e6;
  return 3e6 / ((divisor & 0x3fff) + kParts[divisor >> 14]);
}

Answer greeting_answer(std::span<const std::uint8_t> received) noexcept {
  while (!received.empty() && received.front() == 0) received = received.subspan(1);
  return starts_as(received, kGreetingAnswer);
}

Answer echo(std::span<const std::uint8_t> sent, std::span<const std::uint8_t> received) noexcept {
  return received.size() > sent.size() ? Answer::wrong : starts_as(received, sent);
}

std::span<const std::uint8_t> chunk(std::span<const std::uint8_t> firmware,
                                    std::size_t index) noexcept {
  if (index > firmware.size() / kChunkBytes) return {};
  const auto rest = firmware.subspan(index * kChunkBytes);
  return rest.first(std::min(rest.size(), kChunkBytes));
}

}  // namespace hapticd::usb::falcon
