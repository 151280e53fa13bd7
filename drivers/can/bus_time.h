// How long frames occupy a bus, from the bit layouts of ISO 11898-1:2015. Stuff bits depend on the data; the worst case
// is what a budget counts.
//
//   classic  start, identifier, control, data, CRC 15 | delimiter, acknowledge 2, end 7, interframe 3. Stuffing covers
//            the part before the bar: 34 + 8 n bits of a standard frame, 54 + 8 n of an extended one, and adds at most
//            one bit for every four after the first.
//   FD       arbitration at the nominal rate up to the bit-rate switch, data and CRC at the fast one. CRC 17 up to 16
//            bytes, 21 above, with a stuff count of 4 bits and fixed stuff bits of its own: one in front, and one after
//            every four.
#pragma once
#include "drivers/can/frame.h"

namespace hapticd::can {

/// Bits of a classic frame with the interframe space: as it is, and at worst for any id and data of its size.
int classic_bits(const Frame& frame) noexcept;
int worst_classic_bits(std::size_t size, bool extended) noexcept;

struct BitRates {
  double nominal_Hz = 1e6;
  double data_Hz = 5e6;  ///< of FD frames with the higher rate
};
/// s on the bus with the interframe space, at worst and at least; `size` is a legal length.
double worst_fd_s(std::size_t size, bool extended, const BitRates& rates) noexcept;
double least_fd_s(std::size_t size, bool extended, const BitRates& rates) noexcept;

}  // namespace hapticd::can
