// Brings stamps of another clock (an adapter's, the kernel's) to the clock of the loop. No frame is seen before it was
// stamped, so the least difference ever seen is the offset of the clocks, and the least delay; it may grow slowly,
// because clocks drift.
#pragma once
#include <algorithm>
#include <cstdint>

namespace hapticd::can {

class StampClock {
 public:
  /// When the frame of `stamp_ns` came, at most `seen_ns`, when it was found.
  std::int64_t bring(std::int64_t stamp_ns, std::int64_t seen_ns) noexcept {
    const std::int64_t offset_ns = seen_ns - stamp_ns;
    if (!known_) {
      offset_ns_ = offset_ns;
      known_ = true;
    } else {
      constexpr std::int64_t kDrift = 10'000;  // 100 ppm
      offset_ns_ =
          std::min(offset_ns, offset_ns_ + std::max<std::int64_t>(0, seen_ns - last_ns_) / kDrift);
    }
    last_ns_ = seen_ns;
    return stamp_ns + offset_ns_;
  }

 private:
  bool known_ = false;
  std::int64_t offset_ns_ = 0, last_ns_ = 0;
};

}  // namespace hapticd::can
