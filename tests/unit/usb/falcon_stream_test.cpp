#include <algorithm>

#include "tests/unit/usb/falcon_packets.h"

namespace hapticd::usb::falcon {
namespace {

using Offset = std::ptrdiff_t;

TEST(FalconStream, FindsThePacketsOfTheVectors) {
  each_vector("falcon_stream", [](const Json& vector) {
    Receiver receiver;
    Json found = Json::array();
    for (const Json& packet : vector.at("usb_in_packets"))
      for (const Sample& sample : received(receiver, bytes(packet.get<std::string>())))
        found.push_back({{"encoders", sample.encoder_counts},
                         {"homing_bits", sample.homed},
                         {"grip_bits", sample.buttons}});
    EXPECT_EQ(found, vector.at("frames"));
    EXPECT_EQ(receiver.stream().dropped(), vector.at("bytes_dropped").get<std::uint64_t>());
    EXPECT_EQ(receiver.stream().held(), vector.at("bytes_left").get<std::size_t>());
  });
}

TEST(FalconStream, StatusBytesComeAgainEvery64OfALongTransfer) {
  std::mt19937 random(3);
  Bytes line;
  std::vector<Sample> sent;
  for (int i = 0; i < 20; ++i) {
    sent.push_back(any_sample(random));
    const Bytes packet = sent_by_device(sent.back());
    line.insert(line.end(), packet.begin(), packet.end());
  }
  Bytes transfer;
  for (std::size_t at = 0; at < line.size(); ++at) {
    if (transfer.size() % 64 == 0) transfer.insert(transfer.end(), {0x01, 0x60});
    transfer.push_back(line[at]);
  }
  Receiver receiver;
  EXPECT_EQ(received(receiver, transfer), sent);
  EXPECT_EQ(receiver.stream().dropped(), 0U);
  const auto again = receiver.take(transfer);
  EXPECT_EQ(again.packets, 20);
  EXPECT_EQ(again.newest, sent.back());
}

TEST(FalconStream, TransfersTooShortForStatusAreNoData) {
  Receiver receiver;
  for (const char* text : {"", "01", "0160"}) {
    const auto none = receiver.take(bytes(text));
    EXPECT_FALSE(none.newest);
    EXPECT_FALSE(none.line_error);
  }
  EXPECT_EQ(receiver.stream().dropped(), 0U);
}

/// The public driver once took a runt over an old buffer for a packet, with all legs homed.
TEST(FalconStream, ARuntOverAnOldPacketIsNoPacket) {
  Receiver receiver;
  const Sample good{.encoder_counts = {100, -100, 50}, .homed = 7};
  Bytes transfer = bytes("0160");
  const Bytes packet = sent_by_device(good);
  transfer.insert(transfer.end(), packet.begin(), packet.end());
  EXPECT_EQ(receiver.take(transfer).newest, good);
  EXPECT_FALSE(receiver.take(std::span(transfer).first(16)).newest);
  EXPECT_EQ(receiver.take(transfer).newest, good);
  EXPECT_EQ(receiver.stream().dropped(), 14U);
}

struct Line {
  std::vector<Sample> samples;
  Bytes bytes;
};
Line line_of(std::size_t packets, std::mt19937& random) {
  Line line;
  for (std::size_t i = 0; i < packets; ++i) {
    line.samples.push_back(any_sample(random));
    const Bytes packet = sent_by_device(line.samples.back());
    line.bytes.insert(line.bytes.end(), packet.begin(), packet.end());
  }
  return line;
}
std::vector<Sample> through_usb(const Bytes& line, std::mt19937& random) {
  Receiver receiver;
  std::vector<Sample> found;
  for (const Bytes& packet : usb_packets(line, random))
    for (const Sample& sample : received(receiver, packet)) found.push_back(sample);
  EXPECT_EQ(receiver.stream().dropped() + receiver.stream().held() + 16 * found.size(),
            line.size());
  return found;
}
/// Those that [from, to) of the line leaves whole.
std::vector<Sample> whole(const Line& line, std::size_t from, std::size_t to) {
  std::vector<Sample> left;
  for (std::size_t i = 0; i < line.samples.size(); ++i)
    if (16 * i + 16 <= from || 16 * i >= to) left.push_back(line.samples[i]);
  return left;
}

TEST(FalconStream, AHundredThousandLossesLeaveExactlyThePacketsThatAreWhole) {
  std::mt19937 random(4);
  for (int cut = 0; cut < 100000; ++cut) {
    const Line line = line_of(4, random);
    const std::size_t from = random() % line.bytes.size();
    const std::size_t to = from + 1 + random() % (line.bytes.size() - from);
    // The format cannot tell these: see the next test.
    if (from % 16 != 0 && (to - from) % 16 == 0) continue;
    Bytes left = line.bytes;
    left.erase(left.begin() + static_cast<Offset>(from), left.begin() + static_cast<Offset>(to));
    ASSERT_EQ(through_usb(left, random), whole(line, from, to)) << from << " to " << to;
  }
}

TEST(FalconStream, WhatTheBridgeSaysItLostIsNotPutTogether) {
  std::mt19937 random(5);
  for (int i = 0; i < 1000; ++i) {
    const Line line = line_of(4, random);
    const auto from = static_cast<Offset>(17 + random() % 15);
    const Bytes& all = line.bytes;
    Bytes before = bytes("0160"), after = bytes("0162"), then = bytes("0160");
    before.insert(before.end(), all.begin(), all.begin() + from);
    after.insert(after.end(), all.begin() + from + 16, all.begin() + 48);
    then.insert(then.end(), all.begin() + 48, all.end());
    Receiver receiver;
    ASSERT_EQ(receiver.take(before).newest, line.samples[0]);
    const auto lost = receiver.take(after);
    ASSERT_FALSE(lost.newest);
    ASSERT_TRUE(lost.line_error);
    ASSERT_EQ(receiver.take(then).newest, line.samples[3]);
    ASSERT_EQ(receiver.stream().dropped(), 16U);
  }
}

TEST(FalconStream, ExtraBytesCostOnlyThePacketThatTheyAreIn) {
  std::mt19937 random(6);
  for (int i = 0; i < 100000; ++i) {
    const Line line = line_of(3, random);
    const std::size_t at = random() % (line.bytes.size() + 1);
    Bytes extra;
    for (std::size_t n = 1 + random() % 20; n > 0; --n) {
      const auto byte = static_cast<std::uint8_t>(random());
      extra.push_back(byte == '<' || byte == '>' ? std::uint8_t{'A'} : byte);
    }
    Bytes longer = line.bytes;
    longer.insert(longer.begin() + static_cast<Offset>(at), extra.begin(), extra.end());
    const std::size_t hit = at % 16 == 0 ? at : at + 1;
    ASSERT_EQ(through_usb(longer, random), whole(line, at, hit)) << at;
  }
}

/// The rule as the vectors state it, with room for all bytes: drop up to '<', take 16; if they are none, drop one.
std::vector<Sample> by_rescan(std::span<const std::uint8_t> line) {
  std::vector<Sample> found;
  while (line.size() >= 16) {
    const auto sample = decode(line.first(16));
    if (sample) found.push_back(*sample);
    line = line.subspan(sample ? 16 : 1);
  }
  return found;
}

TEST(FalconStream, FindsInAnySoupWhatARescanFinds) {
  std::mt19937 random(7);
  std::size_t found = 0;
  for (int i = 0; i < 20000; ++i) {
    Line line = line_of(4, random);
    for (std::size_t changes = random() % 6; changes > 0; --changes) {
      const auto at = line.bytes.begin() + static_cast<Offset>(random() % line.bytes.size());
      const auto byte = static_cast<std::uint8_t>("<>AP<>\x40\xc1"[random() % 8]);
      if (random() % 3 == 0) {
        line.bytes.erase(at);
      } else if (random() % 2 == 0) {
        line.bytes.insert(at, byte);
      } else {
        *at = byte;
      }
    }
    const std::vector<Sample> samples = through_usb(line.bytes, random);
    ASSERT_EQ(samples, by_rescan(line.bytes)) << hex(line.bytes);
    found += samples.size();
  }
  EXPECT_GT(found, 20000U);
}

}  // namespace
}  // namespace hapticd::usb::falcon
