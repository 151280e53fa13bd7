// Latest<T>: one writer, any readers, newest value wins. A seqlock over atomic words, so that
// neither side ever waits: the reader gives up after a few tries and keeps what it had.
#pragma once
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "control/core/capacity.h"

namespace hapticd::rt {

template <class T>
class Latest {
  static_assert(std::is_trivially_copyable_v<T>);
  static constexpr std::size_t kWords = (sizeof(T) + 7) / 8;
  static constexpr int kTries = 3;

 public:
  /// Writer (one thread).
  void store(const T& value) noexcept {
    std::array<std::uint64_t, kWords> words{};
    std::memcpy(words.data(), &value, sizeof(T));
    const std::uint64_t sequence = sequence_.load(std::memory_order_relaxed);
    sequence_.store(sequence + 1, std::memory_order_relaxed);
    // Release on every word: whoever sees a new word also sees the odd sequence before it.
    for (std::size_t i = 0; i < kWords; ++i) words_[i].store(words[i], std::memory_order_release);
    sequence_.store(sequence + 2, std::memory_order_release);
  }

  /// Reader. True and a whole value, or false with `value` untouched: nothing stored yet, or the
  /// writer was at it each time.
  [[nodiscard]] bool load(T& value) const noexcept {
    for (int attempt = 0; attempt < kTries; ++attempt) {
      const std::uint64_t before = sequence_.load(std::memory_order_acquire);
      if (before == 0) return false;
      if ((before & 1u) != 0) continue;
      std::array<std::uint64_t, kWords> words{};
      for (std::size_t i = 0; i < kWords; ++i) words[i] = words_[i].load(std::memory_order_acquire);
      if (sequence_.load(std::memory_order_relaxed) != before) continue;
      std::memcpy(static_cast<void*>(&value), words.data(),
                  sizeof(T));  // T may have default initialisers
      return true;
    }
    return false;
  }

  /// How many values were stored.
  std::uint64_t count() const noexcept { return sequence_.load(std::memory_order_acquire) / 2; }

 private:
  alignas(kCacheLine) std::atomic<std::uint64_t> sequence_{0};
  std::array<std::atomic<std::uint64_t>, kWords> words_{};
};

}  // namespace hapticd::rt
