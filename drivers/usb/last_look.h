// When something came, as far as the thread that fetches it can say: since it looked the last time. A thread that was kept
// from looking must not take old samples for new ones.
#pragma once
#include <cstdint>

namespace hapticd::usb {

class LastLook {
 public:
  /// Who waits looks at least so often, and a little later.
  static constexpr std::int64_t kEvery_ns = 1'000'000;

  /// Of what is found at `now_ns`; not later than it came, but for what a wait that ends at once may take.
  std::int64_t stamp(std::int64_t now_ns) const noexcept {
    constexpr std::int64_t kUsual_ns = 2 * kEvery_ns;
    if (away_ns_ != 0) return away_ns_;
    return looked_ns_ == 0 || now_ns - looked_ns_ <= kUsual_ns ? now_ns : looked_ns_;
  }
  /// From then on the thread is busy with something else, and sees nothing that comes.
  void away(std::int64_t since_ns) noexcept {
    if (away_ns_ == 0) away_ns_ = since_ns;
  }
  /// All that was there by `before_ns` has been found: the time is that before the look.
  void looked(std::int64_t before_ns) noexcept {
    looked_ns_ = before_ns;
    away_ns_ = 0;
  }

 private:
  std::int64_t looked_ns_ = 0, away_ns_ = 0;
};

}  // namespace hapticd::usb
