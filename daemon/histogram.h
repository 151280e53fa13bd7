// Histogram of durations with one writer (the servo thread) and any readers: 32 steps per octave, so a percentile is
// right to about 3 %. Counting costs one relaxed load and store; nothing is allocated.
#pragma once
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
    bump(counts_[index(value)], 1);
    bump(total_, 1);
    if (value > max_.load(std::memory_order_relaxed)) max_.store(value, std::memory_order_relaxed);
  }

  std::uint64_t count() const noexcept { return total_.load(std::memory_order_relaxed); }
  std::uint64_t max_ns() const noexcept { return max_.load(std::memory_order_relaxed); }

  /// Upper edge of the bucket that holds the given share (0 to 1) of all values, at most max_ns(); 0 when empty.
  std::uint64_t percentile_ns(double share) const noexcept {
    const auto wanted = static_cast<std::uint64_t>(share * static_cast<double>(count()));
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < kBuckets; ++i) {
      seen += counts_[i].load(std::memory_order_relaxed);
      if (seen > wanted || (seen == wanted && seen > 0 && seen == count())) {
        return upper_edge(i) < max_ns() ? upper_edge(i) : max_ns();
      }
    }
    return max_ns();
  }

 private:
  static constexpr std::size_t kSteps = 32;
  static constexpr std::size_t kOctaves = 32;  // up to 2^36 ns: over a minute
  static constexpr std::size_t kBuckets = kSteps * kOctaves;

  static std::size_t index(std::uint64_t value) noexcept {
    if (value < kSteps) return static_cast<std::size_t>(value);
    const auto octave = static_cast<std::size_t>(std::bit_width(value)) - 5;  // value >> octave is 16 to 31...
    const auto step = static_cast<std::size_t>(value >> (octave - 1)) - kSteps;
    const std::size_t i = octave * kSteps + step;
    return i < kBuckets ? i : kBuckets - 1;
  }
  static std::uint64_t upper_edge(std::size_t i) noexcept {
    if (i < kSteps) return i;
    const std::size_t octave = i / kSteps;
    const std::uint64_t step = i % kSteps;
    return ((kSteps + step + 1) << (octave - 1)) - 1;
  }
  static void bump(std::atomic<std::uint64_t>& counter, std::uint64_t by) noexcept {
    counter.store(counter.load(std::memory_order_relaxed) + by, std::memory_order_relaxed);
  }

  std::array<std::atomic<std::uint64_t>, kBuckets> counts_{};
  std::atomic<std::uint64_t> total_{0};
  std::atomic<std::uint64_t> max_{0};
};

}  // namespace hapticd::daemon
