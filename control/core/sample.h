// What a driver hands to the tick: one AxisSample per axis, one Aux per device.
#pragma once
#include <array>
#include <cstdint>

namespace hapticd {

/// Where the value of an AxisSample comes from.
enum class Freshness : std::uint8_t {
  missing,   ///< no value at all this tick: `raw` is not to be read
  repeated,  ///< the device gave an old value again
  fresh,     ///< measured for this tick (not older than DeviceInfo::worst_sample_age_s)
  first,  ///< fresh, and the first since the device came: it may count from elsewhere than before
};

/// One axis as the device reports it, in the device's own unit. Trivially copyable.
struct AxisSample {
  double raw = 0;             ///< encoder value in the device's unit: counts or turns
  std::int64_t stamp_ns = 0;  ///< CLOCK_MONOTONIC when it was measured, as well as the driver knows
  std::int64_t age_ns = 0;    ///< age at collect
  double index_raw = 0;       ///< `raw` at the latest index pulse; to be read only if `index`
  Freshness freshness = Freshness::missing;
  bool homed = false;              ///< the device says that its zero is known
  bool index = false;              ///< the index pulse has been seen since connect()
  std::uint16_t drive_limits = 0;  ///< limiters that the drive itself reports, driver-specific bits
  std::uint32_t drive_faults = 0;  ///< faults that the drive itself reports, driver-specific bits
};

/// What else a device reports each tick. Records copy it whole, so it has no padding, whose bytes
/// would differ from run to run.
struct Aux {
  std::uint32_t digital = 0;  ///< buttons, dead-man, e-stop: one bit each
  bool armed = false;         ///< power stage on: efforts that are commanded are delivered
  bool faulted = false;       ///< the device cannot go on; Device::fault_text says why
  std::uint16_t unused = 0;
  std::array<double, 6> analogue{};  ///< force sensor and the like, SI
};
static_assert(sizeof(Aux) == 56);

}  // namespace hapticd
