// Counters that people should hear of, without the log being filled: the first time at once, then
// at most once a minute with how many there were since. Pure: time comes in as an argument.
#pragma once
#include <cstdint>
#include <optional>

namespace hapticd::daemon {

class RateLimitedCount {
 public:
  /// `total` counts up. How many came since the last report, when it is time to report; else none.
  std::optional<std::uint64_t> due(std::uint64_t total, std::int64_t now_ns) noexcept {
    const bool waits = told_ && now_ns - last_ns_ < kQuiet_ns;
    if (total <= reported_ || waits) return std::nullopt;
    const std::uint64_t fresh = total - reported_;
    reported_ = total;
    last_ns_ = now_ns;
    told_ = true;
    return fresh;
  }

 private:
  static constexpr std::int64_t kQuiet_ns = 60'000'000'000;
  std::uint64_t reported_ = 0;
  std::int64_t last_ns_ = 0;
  bool told_ = false;
};

/// Whether a counter still moves: for the watchdog, and for telling once that the loop went silent
/// and once that it is back.
class Heartbeat {
 public:
  enum class Change { none, went_silent, came_back };

  explicit Heartbeat(std::int64_t now_ns) noexcept : last_move_ns_(now_ns) {}

  Change look(std::uint64_t count, std::int64_t now_ns) noexcept {
    if (count != count_) {
      count_ = count;
      last_move_ns_ = now_ns;
      if (!silent_) return Change::none;
      silent_ = false;
      return Change::came_back;
    }
    if (silent_ || now_ns - last_move_ns_ <= kSilence_ns) return Change::none;
    silent_ = true;
    return Change::went_silent;
  }

 private:
  static constexpr std::int64_t kSilence_ns = 1'000'000'000;
  std::uint64_t count_ = 0;
  std::int64_t last_move_ns_ = 0;
  bool silent_ = false;
};

}  // namespace hapticd::daemon
