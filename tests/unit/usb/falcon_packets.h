// The Falcon's side of its packets, written for the tests alone.
#pragma once
#include <random>

#include "drivers/usb/falcon_codec.h"
#include "tests/unit/usb/vectors.h"

namespace hapticd::usb::falcon {

/// As the device would send it.
inline Bytes sent_by_device(const Sample& sample) {
  Bytes packet{'<'};
  for (const std::int16_t counts : sample.encoder_counts) {
    int rest = counts < 0 ? counts + 65536 : counts;
    for (int nibble = 0; nibble < 4; ++nibble, rest /= 16)
      packet.push_back(static_cast<std::uint8_t>("ABCDEFGHIJKLMNOP"[rest % 16]));
  }
  packet.push_back(static_cast<std::uint8_t>(0x41 + sample.homed * 16 + sample.buttons));
  packet.push_back('A');
  packet.push_back('>');
  return packet;
}

inline Sample any_sample(std::mt19937& random) {
  Sample sample;
  for (std::int16_t& counts : sample.encoder_counts)
    counts = static_cast<std::int16_t>(static_cast<int>(random() % 65536) - 32768);
  sample.homed = random() % 8;
  sample.buttons = random() % 16;
  return sample;
}

/// Packs `line` into USB packets of random length, each behind two status bytes.
inline std::vector<Bytes> usb_packets(std::span<const std::uint8_t> line, std::mt19937& random) {
  std::vector<Bytes> packets;
  while (!line.empty()) {
    const std::size_t size = std::min<std::size_t>(line.size(), random() % 63);
    Bytes packet{0x01, 0x60};
    packet.insert(packet.end(), line.begin(), line.begin() + static_cast<std::ptrdiff_t>(size));
    packets.push_back(packet);
    line = line.subspan(size);
  }
  return packets;
}

inline std::vector<Sample> received(Receiver& receiver, std::span<const std::uint8_t> transfer) {
  std::vector<Sample> samples;
  receiver.take_each(transfer, [&](const Sample& sample) { samples.push_back(sample); });
  return samples;
}

}  // namespace hapticd::usb::falcon
