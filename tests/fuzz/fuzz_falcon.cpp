// The Falcon's packets: what a receiver gives was in the bytes, whole and together; nothing is counted twice or vanishes.
#include <array>
#include <vector>

#include "drivers/usb/falcon_codec.h"
#include "tests/fuzz/protocol.h"

namespace hapticd::fuzz {
namespace {

using namespace usb::falcon;
using Bytes = std::vector<std::uint8_t>;

Bytes take(Input& input, std::size_t count) {
  Bytes bytes(count);
  for (std::uint8_t& byte : bytes) byte = input.byte();
  return bytes;
}

int nibbles(const std::uint8_t* first) {
  int value = 0;
  for (int i = 3; i >= 0; --i) value = value * 16 + (first[i] - 'A');
  return value < 32768 ? value : value - 65536;
}

/// `packet`: the 16 bytes that the sample should be of.
void must_be_in(const Sample& sample, const std::uint8_t* packet) {
  must(packet[0] == '<' && packet[15] == '>', "a packet has its brackets");
  for (std::size_t leg = 0; leg < 3; ++leg)
    must(sample.encoder_counts[leg] == nibbles(packet + 1 + 4 * leg), "the counts are those sent");
  must(sample.homed * 16 + sample.buttons == packet[13] - 'A', "so is the status");
  must(sample.homed <= 7 && sample.buttons <= 15, "it has no more bits");
}

void packet(Input& input) {
  const Bytes bytes = take(input, kPacketBytes + (input.byte() % 3) - 1);
  const auto sample = usb::falcon::decode(bytes);
  if (!sample) return;
  must(bytes.size() == kPacketBytes, "a packet has 16 bytes");
  must_be_in(*sample, bytes.data());
}

/// A transfer, of which half the bytes make up packets, so that there are some.
Bytes transfer_of(Input& input) {
  Bytes transfer{1, static_cast<std::uint8_t>(input.byte() % 8 == 0 ? input.byte() : 0x60)};
  for (int i = input.byte() % 6; i > 0; --i) {
    const std::uint8_t kind = input.byte();
    Bytes piece = take(input, kind % 18);
    if ((kind & 0x80) != 0 && piece.size() == kPacketBytes) {
      for (std::uint8_t& byte : piece) byte = static_cast<std::uint8_t>('A' + byte % 16);
      piece.front() = '<';
      piece.back() = '>';
    }
    transfer.insert(transfer.end(), piece.begin(), piece.end());
  }
  if (input.byte() % 16 == 0) transfer.resize(input.byte() % 3);
  return transfer;
}

void stream(Input& input) {
  Receiver receiver;
  Bytes since_error;  // of the line, without those that came with an error and before
  std::size_t all = 0, packets = 0;
  while (!input.empty()) {
    const Bytes transfer = transfer_of(input);
    Bytes good;
    bool error = false;
    for (std::size_t at = 0; at < transfer.size(); at += kUsbPacketBytes) {
      const std::size_t end = std::min(at + kUsbPacketBytes, transfer.size());
      if (end - at < kStatusBytes) continue;
      all += end - at - kStatusBytes;
      error = error || (transfer[at + 1] & 0x1e) != 0;
      if ((transfer[at + 1] & 0x1e) != 0) {
        good.clear();
        since_error.clear();
        continue;
      }
      const auto begin = transfer.begin();
      good.insert(good.end(), begin + static_cast<std::ptrdiff_t>(at + kStatusBytes),
                  begin + static_cast<std::ptrdiff_t>(end));
    }
    int seen = 0;
    std::optional<Sample> last;
    const auto received = receiver.take_each(transfer, [&](const Sample& sample) {
      ++seen;
      last = sample;
    });
    packets += static_cast<std::size_t>(seen);
    since_error.insert(since_error.end(), good.begin(), good.end());
    must(received.packets == seen && received.newest == last, "the newest is the last");
    must(received.line_error == error, "an error is told");
    const Deframer& deframer = receiver.stream();
    must(deframer.held() < kPacketBytes, "no more is held than may become a packet");
    must(deframer.dropped() + deframer.held() + kPacketBytes * packets == all, "no byte vanishes");
    // What was found last lies in the bytes since the last error.
    if (!last || error) continue;
    bool found = false;
    for (std::size_t at = 0; at + kPacketBytes <= since_error.size() && !found; ++at) {
      const auto there = usb::falcon::decode(std::span(since_error).subspan(at, kPacketBytes));
      if ((found = there == last)) must_be_in(*last, since_error.data() + at);
    }
    must(found, "a sample was in the bytes");
  }
}

/// Any answer while booting: what is right is so for the reason that it says.
void boot(Input& input) {
  const Bytes sent = take(input, input.byte() % 65), received = take(input, input.byte() % 70);
  const bool whole = received == sent;
  const bool begin =
      received.size() < sent.size() && std::equal(received.begin(), received.end(), sent.begin());
  const Answer expected = whole ? Answer::right : begin ? Answer::incomplete : Answer::wrong;
  must(echo(sent, received) == expected, "an echo is the same bytes");
  must(echo(sent, sent) == Answer::right, "what comes back is an echo");
  Bytes greeting(received.size() % 4, 0);
  greeting.insert(greeting.end(), kGreetingAnswer.begin(), kGreetingAnswer.end());
  greeting.insert(greeting.end(), received.begin(), received.end());
  must(greeting_answer(greeting) == Answer::right, "zeros before and bytes behind are let pass");
  const Answer any = greeting_answer(received);
  const auto first = std::find_if(received.begin(), received.end(), [](auto b) { return b != 0; });
  const std::size_t left = static_cast<std::size_t>(received.end() - first);
  const bool same =
      std::equal(first, first + static_cast<std::ptrdiff_t>(std::min(left, std::size_t{4})),
                 kGreetingAnswer.begin());
  must(any == (!same      ? Answer::wrong
               : left < 4 ? Answer::incomplete
                          : Answer::right),
       "the answer");
  Bytes joined;
  for (std::size_t i = 0; !chunk(received, i).empty(); ++i) {
    const auto piece = chunk(received, i);
    must(piece.size() <= kChunkBytes, "a chunk fits");
    joined.insert(joined.end(), piece.begin(), piece.end());
  }
  must(joined == received, "the chunks are the file");
  must(baud_of(input.take<std::uint16_t>()) > 0, "any divisor has a rate");
}

}  // namespace

void decode(Input& input) {
  switch (input.byte() % 4) {
    case 0:
      return packet(input);
    case 1:
      return boot(input);
    default:
      return stream(input);
  }
}

void encode(Input& input) {
  Command command;
  bool finite = true, beyond = false;
  for (double& counts : command.motor_counts) {
    counts = input.number();
    finite = finite && std::isfinite(counts);
    beyond = beyond || std::round(counts) > 32767 || std::round(counts) < -32768;
  }
  const std::uint8_t bits = input.byte();
  command.homing = (bits & 1) != 0;
  command.green = (bits & 2) != 0;
  command.blue = (bits & 4) != 0;
  command.red = (bits & 8) != 0;
  const auto encoded = usb::falcon::encode(command);
  must(encoded.has_value() == finite, "refused where a value is no number");
  if (!encoded) return;
  must(encoded->saturated == beyond, "clipped where it is too large");
  must(encoded->packet[13] == 'A' + (bits & 15), "lights and homing");
  const auto back = usb::falcon::decode(encoded->packet);
  must(back.has_value(), "what is sent is a packet");
  for (std::size_t leg = 0; leg < 3; ++leg) {
    must(back->encoder_counts[leg] == encoded->motor_counts[leg], "the counts are in it");
    const double nearest = std::clamp(std::round(command.motor_counts[leg]), -32768.0, 32767.0);
    must(encoded->motor_counts[leg] == nearest, "the nearest, or the largest");
  }
}

}  // namespace hapticd::fuzz
