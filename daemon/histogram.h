// Histogram of durations with one writer (the servo thread) and any readers: 32 steps per octave,
// so a percentile is never too small and at most 1/32 too large. Counting costs a few relaxed loads
// and stores; nothing is allocated.
#pragma once
#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace hapticd::daemon {

class Histogram {
 public:
  /// `ns` below zero counts as zero.
  void add(std::int64_t ns) noexcept {
    const auto value = static_cast<std::uint64_t>(ns < 0 ? 0 : ns);
    bump(counts_[index(value)]);
    bump(total_);
    if (value > max_.load(std::memory_order_relaxed)) max_.store(value, std::memory_order_relaxed);
  }

  std::uint64_t count() const noexcept { return total_.load(std::memory_order_relaxed); }
  std::uint64_t max_ns() const noexcept { return max_.load(std::memory_order_relaxed); }

  /// Of n values in ascending order the one at position floor(share * n), counted from 0 (the last
  /// one for share 1), as the upper edge of its bucket but at most max_ns(); 0 when empty.
  std::uint64_t percentile_ns(double share) const noexcept {
    const std::uint64_t n = count();
    if (n == 0) return 0;
    const double position = std::clamp(share, 0.0, 1.0) * static_cast<double>(n);
    const std::uint64_t wanted = std::min(static_cast<std::uint64_t>(position), n - 1);
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i + 1 < kBuckets; ++i) {
      seen += counts_[i].load(std::memory_order_relaxed);
      if (seen > wanted) return std::min(upper_edge(i), max_ns());
    }
    return max_ns();  // the last bucket has no upper edge
  }

  static constexpr std::size_t kSteps = 32;  ///< per octave
  static constexpr std::size_t kOctaves =
      32;  ///< up to 2^36 ns: over a minute; the last bucket takes what is longer
  static constexpr std::size_t kBuckets = kSteps * kOctaves;

  /// Values below kSteps have a bucket each. Above, the leading six bits name the bucket: 1, then
  /// five for the step.
  static constexpr std::size_t index(std::uint64_t value) noexcept {
    if (value < kSteps) return static_cast<std::size_t>(value);
    const auto octave = static_cast<std::size_t>(std::bit_width(value)) - 5;  // 1 for 32 to 63
    const auto step = static_cast<std::size_t>(value >> (octave - 1)) - kSteps;
    return std::min(octave * kSteps + step, kBuckets - 1);
  }
  /// Largest value of bucket i.
  static constexpr std::uint64_t upper_edge(std::size_t i) noexcept {
    if (i < kSteps) return i;
    const std::size_t octave = i / kSteps;
    const std::uint64_t step = i % kSteps;
    return ((kSteps + step + 1) << (octave - 1)) - 1;
  }

 private:
  static void bump(std::atomic<std::uint64_t>& counter) noexcept {
    counter.store(counter.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
  std::atomic<std::uint64_t> total_{0};
  std::atomic<std::uint64_t> max_{0};
};

}  // namespace hapticd::daemon
