// How long a frame occupies the bus, interframe space included.
#pragma once
#include <cstdint>

#include "sim/can/frame.h"

namespace hapticd::sim::can {

struct BitRates {
  double nominal_Hz = 1e6;
  double data_Hz = 5e6;  ///< of FD frames with CANFD_BRS, from BRS to the CRC delimiter
};

/// For random data: a stuff bit in 32 bits, on average.
std::int64_t bus_time_ns(const Frame& frame, BitRates rates);

/// Smaller wins the arbitration. ISO 11898-1: 11 bits of the id, then standard before extended,
/// then the other 18 bits; data before remote requests.
std::uint64_t arbitration_key(const Frame& frame);

/// Can a controller send it: classic up to 8 bytes, FD only the lengths that its DLC can say?
bool is_sendable(const Frame& frame);

}  // namespace hapticd::sim::can
