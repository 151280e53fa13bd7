#include "sim/can/bus_time.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace hapticd::sim::can {
namespace {

constexpr double kStuffed = 1.0 / 32;

// Bits from SOF to the end of the CRC are stuffed; delimiters, ACK, EOF and interframe are not.
double classic_bits(const Frame& frame) {
  const double data = is_rtr(frame) ? 0 : 8 * frame.len;
  const double stuffed = (is_extended(frame) ? 54 : 34) + data;
  return stuffed + 13 + stuffed * kStuffed;
}

struct FdBits {
  double nominal = 0, data = 0;
};

FdBits fd_bits(const Frame& frame) {
  const double arbitration = is_extended(frame) ? 36 : 17;  // SOF to BRS
  const double tail = 13;                                   // CRC delimiter, ACK, EOF, interframe
  const double body = 5 + 8 * frame.len;                    // ESI, DLC, data
  const double checksum = frame.len > 16 ? 4 + 21 + 7 : 4 + 17 + 6;  // with its fixed stuff bits
  return {arbitration + tail + arbitration * kStuffed, body + checksum + body * kStuffed};
}

}  // namespace

std::int64_t bus_time_ns(const Frame& frame, BitRates rates) {
  if (!is_fd(frame)) return std::llround(1e9 * classic_bits(frame) / rates.nominal_Hz);
  const FdBits bits = fd_bits(frame);
  const double data_Hz = (frame.flags & CANFD_BRS) != 0 ? rates.data_Hz : rates.nominal_Hz;
  return std::llround(1e9 * (bits.nominal / rates.nominal_Hz + bits.data / data_Hz));
}

std::uint64_t arbitration_key(const Frame& frame) {
  const std::uint64_t id = id_of(frame);
  const bool extended = is_extended(frame);
  const std::uint64_t base = extended ? id >> 18 : id;
  const std::uint64_t rest = extended ? id & 0x3ffff : 0;
  return base << 20 | std::uint64_t{extended} << 19 | rest << 1 | std::uint64_t{is_rtr(frame)};
}

bool is_sendable(const Frame& frame) {
  if (is_error(frame)) return false;
  if (!is_fd(frame)) return frame.len <= 8;
  constexpr std::array kLong{12, 16, 20, 24, 32, 48, 64};
  const bool dlc = frame.len <= 8 || std::ranges::find(kLong, frame.len) != kLong.end();
  return dlc && !is_rtr(frame);
}

}  // namespace hapticd::sim::can
