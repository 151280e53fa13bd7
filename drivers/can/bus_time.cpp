#include "drivers/can/bus_time.h"

namespace hapticd::can {
namespace {

constexpr int kTail = 1 + 2 + 7 + 3;  // CRC delimiter, acknowledge, end of frame, interframe

/// Bits as they are sent, stuffed as they come.
class Stuffed {
 public:
  void add(std::uint32_t value, int bits) noexcept {
    for (int i = bits - 1; i >= 0; --i) add_bit((value >> i) & 1);
  }
  std::uint32_t crc() const noexcept { return crc_; }
  int count() const noexcept { return count_; }
  /// A CRC is stuffed, too, but does not go into itself.
  void add_crc() noexcept {
    const std::uint32_t crc = crc_;
    for (int i = 14; i >= 0; --i) stuff((crc >> i) & 1);
  }

 private:
  void add_bit(std::uint32_t bit) noexcept {
    const bool turned = ((crc_ >> 14) & 1) != bit;
    crc_ = (crc_ << 1) & 0x7fff;
    if (turned) crc_ ^= 0x4599;
    stuff(bit);
  }
  void stuff(std::uint32_t bit) noexcept {
    ++count_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ < 5) return;
    ++count_;  // the opposite bit, which begins a run of its own
    last_ = 1 - bit;
    run_ = 1;
  }

  std::uint32_t crc_ = 0, last_ = 2;
  int run_ = 0, count_ = 0;
};

/// Bits of an FD frame by rate: the nominal one up to BRS and from the CRC delimiter on.
struct FdBits {
  int slow, slow_stuffed;  ///< what may be stuffed at the nominal rate
  int fast_stuffed;        ///< likewise at the data rate
  int fast_fixed;          ///< CRC with stuff count and fixed stuff bits
};

FdBits fd_bits(std::size_t size, bool extended) noexcept {
  // start, id 11, RRS, IDE, FDF, res, BRS; extended: id 18, SRR and IDE more, no separate RRS in front
  const int head = extended ? 1 + 11 + 1 + 1 + 18 + 1 + 1 + 1 + 1 : 1 + 11 + 1 + 1 + 1 + 1 + 1;
  const int crc = size <= 16 ? 17 : 21;
  const int guarded = 4 + crc;                  // stuff count and CRC
  const int fixed = 1 + (guarded + 3) / 4 - 1;  // one in front, one after every four but the last
  return {.slow = kTail,
          .slow_stuffed = head,
          .fast_stuffed = 1 + 4 + 8 * static_cast<int>(size),  // ESI, length, data
          .fast_fixed = guarded + fixed};
}

double fd_s(const FdBits& bits, int slow_stuff, int fast_stuff, const BitRates& rates) noexcept {
  return (bits.slow + bits.slow_stuffed + slow_stuff) / rates.nominal_Hz +
         (bits.fast_stuffed + bits.fast_fixed + fast_stuff) / rates.data_Hz;
}

}  // namespace

int classic_bits(const Frame& frame) noexcept {
  Stuffed bits;
  bits.add(0, 1);
  if (frame.extended) {
    bits.add(frame.id >> 18, 11);
    bits.add(3, 2);  // SRR, IDE
    bits.add(frame.id & 0x3ffff, 18);
    bits.add(frame.remote ? 1 : 0, 1);
    bits.add(0, 2);
  } else {
    bits.add(frame.id, 11);
    bits.add(frame.remote ? 1 : 0, 1);
    bits.add(0, 2);
  }
  bits.add(frame.size, 4);
  for (const std::uint8_t byte : frame.payload()) bits.add(byte, 8);
  bits.add_crc();
  return bits.count() + kTail;
}

int worst_classic_bits(std::size_t size, bool extended) noexcept {
  const int covered = (extended ? 54 : 34) + 8 * static_cast<int>(size);
  return covered + kTail + (covered - 1) / 4;
}

double worst_fd_s(std::size_t size, bool extended, const BitRates& rates) noexcept {
  const FdBits bits = fd_bits(size, extended);
  // No run crosses the switch of rates: res 0, BRS 1, ESI 0 stand there.
  return fd_s(bits, (bits.slow_stuffed - 1) / 4, (bits.fast_stuffed - 1) / 4, rates);
}

double least_fd_s(std::size_t size, bool extended, const BitRates& rates) noexcept {
  return fd_s(fd_bits(size, extended), 0, 0, rates);
}

}  // namespace hapticd::can
