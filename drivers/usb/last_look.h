// When something came, as far as the thread that fetches it can say: since it looked the last time. A thread that was kept
// from looking must not take old samples for new ones.
#pragma once
#include <cstdint>

namespace hapticd::usb {

class LastLook {
 public:
  /// Who waits looks at least so often, and a little later.
  static constexpr std::int64_t kEvery_ns = 1'000'000;

  /// Of what is found at `now_ns`; never later than it came.
  std::int64_t stamp(std::int64_t now_ns) const noexcept {
    constexpr std::int64_t kUsual_ns = 2 * kEvery_ns;
    return looked_ns_ == 0 || now_ns - looked_ns_ <= kUsual_ns ? now_ns : looked_ns_;
  }
  /// All that was there by `now_ns` has been found.
  void looked(std::int64_t now_ns) noexcept { looked_ns_ = now_ns; }

 private:
  std::int64_t looked_ns_ = 0;
};

}  // namespace hapticd::usb
