// Requests and divisors: FTDI AN232B-05, AN232B-04; buffers: data sheet of the FT232BM.
#include "sim/usb/ftdi_bridge.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hapticd::sim::usb {
namespace {

enum FtdiRequest : std::uint8_t {
  kReset = 0,
  kModemControl = 1,
  kFlowControl = 2,
  kBaudRate = 3,
  kDataFormat = 4,
  kModemStatus = 5,
  kEventChar = 6,
  kErrorChar = 7,
  kSetLatency = 9,
  kGetLatency = 10,
};
constexpr std::uint8_t kVendorOut = 0x40, kVendorIn = 0xc0;
constexpr std::uint16_t k8N1 = 0x0008;
constexpr std::uint8_t kModemBits = 0x01, kLineBits = 0x60, kOverrun = 0x02;

}  // namespace

double ftdi_baud(std::uint16_t value, std::uint16_t index) {
  constexpr double kEighths[] = {0, 4, 2, 1, 3, 5, 6, 7};
  const int whole = value & 0x3fff, fraction = value >> 14 | (index & 1) << 2;
  if (whole == 0) return 3e6;
  if (whole == 1) return 2e6;
  return 3e6 / (whole + kEighths[fraction] / 8);
}

Answer FtdiBridge::request(const Setup& setup, std::int64_t now_ns) {
  if (setup.request_type == kVendorOut) return set(setup, now_ns);
  if (setup.request_type != kVendorIn) return {.kind = Answer::Kind::stall};
  if (setup.request == kModemStatus) return {.bytes = {kModemBits, kLineBits}};
  if (setup.request == kGetLatency)
    return {.bytes = {static_cast<std::uint8_t>(latency_ns_ / 1'000'000)}};
  return {.kind = Answer::Kind::stall};
}

Answer FtdiBridge::set(const Setup& setup, std::int64_t now_ns) {
  switch (setup.request) {
    case kReset:
      reset(setup.value, now_ns);
      return {};
    case kModemControl:
      set_pins(setup.value);
      return {};
    case kFlowControl:
    case kErrorChar:
      return {};
    case kBaudRate:
      baud_ = ftdi_baud(setup.value, setup.index);
      baud_set_ = true;
      return {};
    case kDataFormat:
      eight_n_one_ = setup.value == k8N1;
      return {};
    case kEventChar:
      event_char_ = setup.value & 0x100 ? setup.value & 0xff : -1;
      return {};
    case kSetLatency:
      latency_ns_ = std::clamp<std::int64_t>(setup.value, 1, 255) * 1'000'000;
      return {};
    default:
      return {.kind = Answer::Kind::stall};
  }
}

/// 0: all, 1: what goes to the host, 2: what goes to the line.
void FtdiBridge::reset(std::uint16_t value, std::int64_t now_ns) {
  take_arrived(now_ns);
  if (value != 2) to_host_.clear();
  if (value != 1) to_line_.clear();
  flush_ = overrun_ = false;
  purged_ = true;
}

/// The upper byte says which pins are meant.
void FtdiBridge::set_pins(std::uint16_t value) {
  if (value & 0x100) dtr_ = value & 1;
  if (value & 0x200) rts_ = value & 2;
}

Answer FtdiBridge::out(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  if (to_line_.size() + bytes.size() > kToLineBytes) return {.kind = Answer::Kind::nak};
  std::int64_t at_ns = to_line_.empty() ? now_ns : std::max(now_ns, to_line_.back().at_ns);
  const std::int64_t byte_ns = std::llround(10e9 / baud_);
  for (const std::uint8_t value : bytes)
    to_line_.push_back(
        {.at_ns = at_ns += byte_ns, .value = value, .baud = eight_n_one_ ? baud_ : 0});
  return {};
}

Answer FtdiBridge::in(std::size_t most_bytes, std::int64_t now_ns) {
  take_arrived(now_ns);
  constexpr std::size_t kMostPayload = kPacketBytes - kStatusBytes;
  const bool due = now_ns >= last_packet_ns_ + latency_ns_ || flush_;
  const bool full = to_host_.size() >= kMostPayload;
  const bool idle = to_host_.empty() && !options_.idle_packets;
  if (!full && (!due || idle)) return {.kind = Answer::Kind::nak};
  const std::size_t payload =
      std::min({to_host_.size(), kMostPayload, std::max(most_bytes, kStatusBytes) - kStatusBytes});
  Answer answer;
  answer.bytes.reserve(kStatusBytes + payload);
  answer.bytes.push_back(kModemBits);
  answer.bytes.push_back(kLineBits | (overrun_ ? kOverrun : 0));
  const auto end = to_host_.begin() + static_cast<std::ptrdiff_t>(payload);
  answer.bytes.insert(answer.bytes.end(), to_host_.begin(), end);
  to_host_.erase(to_host_.begin(), end);
  if (to_host_.empty()) flush_ = false;
  overrun_ = false;
  last_packet_ns_ = now_ns;
  return answer;
}

bool FtdiBridge::next_from_host(std::int64_t now_ns, LineByte& byte) {
  if (to_line_.empty() || to_line_.front().at_ns > now_ns) return false;
  byte = to_line_.front();
  to_line_.pop_front();
  return true;
}

void FtdiBridge::from_line(std::uint8_t value, double baud, std::int64_t start_ns) {
  const std::int64_t from_ns =
      coming_.empty() ? start_ns : std::max(start_ns, coming_.back().at_ns);
  coming_.push_back(
      {.at_ns = from_ns + std::int64_t{std::llround(10e9 / baud)}, .value = value, .baud = baud});
}

void FtdiBridge::take_arrived(std::int64_t now_ns) {
  for (; !coming_.empty() && coming_.front().at_ns <= now_ns; coming_.pop_front()) {
    if (to_host_.size() == kToHostBytes) {
      overrun_ = true;
      continue;
    }
    const LineByte& byte = coming_.front();
    const std::uint8_t value =
        same_baud(byte.baud, eight_n_one_ ? baud_ : 0) ? byte.value : garbled(byte.value);
    to_host_.push_back(value);
    if (options_.acts_on_event_char && value == event_char_) flush_ = true;
  }
}

bool FtdiBridge::take_purged() {
  return std::exchange(purged_, false);
}
bool FtdiBridge::take_baud_set() {
  return std::exchange(baud_set_, false);
}

void FtdiBridge::power_up(std::int64_t now_ns) {
  const FtdiOptions options = options_;
  *this = FtdiBridge(options);
  last_packet_ns_ = now_ns;
}

}  // namespace hapticd::sim::usb
