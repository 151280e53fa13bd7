// Ring of fixed-size slots from one writer to one reader, wait-free on both sides. The slot size is
// that of the plan's record, so it is a number and not a type; the caller owns the storage.
//
// Each index has its own cache line beside a cached copy of the other one: as long as the ring is
// neither full nor empty the two threads share no line but the slots themselves.
#pragma once
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>

#include "control/core/capacity.h"

namespace hapticd::rt {

class SpscRing {
 public:
  /// `storage` is 8-byte aligned; it holds storage.size() / slot_bytes slots. slot_bytes: a
  /// multiple of 8, > 0.
  SpscRing(std::span<std::byte> storage, std::size_t slot_bytes) noexcept
      : storage_(storage.data()), slot_bytes_(slot_bytes), slots_(storage.size() / slot_bytes) {}
  SpscRing(const SpscRing&) = delete;
  SpscRing& operator=(const SpscRing&) = delete;

  std::size_t slot_bytes() const noexcept { return slot_bytes_; }
  std::size_t slots() const noexcept { return slots_; }

  /// Writer: the slot to fill, or nullptr when the reader is behind (counted as dropped).
  std::byte* reserve() noexcept {
    const std::uint64_t write = write_.load(std::memory_order_relaxed);
    if (write - read_seen_ >= slots_) {
      read_seen_ = read_.load(std::memory_order_acquire);
      if (write - read_seen_ >= slots_) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return nullptr;
      }
    }
    return storage_ + write_index_ * slot_bytes_;
  }
  /// Writer: hands the slot of the last reserve() to the reader.
  void commit() noexcept {
    if (++write_index_ == slots_) write_index_ = 0;
    write_.store(write_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Reader: the oldest slot, or nullptr when there is none.
  const std::byte* front() noexcept {
    const std::uint64_t read = read_.load(std::memory_order_relaxed);
    if (read == write_seen_) {
      write_seen_ = write_.load(std::memory_order_acquire);
      if (read == write_seen_) return nullptr;
    }
    return storage_ + read_index_ * slot_bytes_;
  }
  /// Reader: gives the slot of front() back.
  void pop() noexcept {
    if (++read_index_ == slots_) read_index_ = 0;
    read_.store(read_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  /// Records that found the ring full, since the start. Any thread.
  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

 private:
  std::byte* const storage_;
  const std::size_t slot_bytes_;
  const std::size_t slots_;
  alignas(kCacheLine) std::atomic<std::uint64_t> write_{0};
  std::uint64_t read_seen_ = 0;
  std::size_t write_index_ = 0;
  std::atomic<std::uint64_t> dropped_{0};
  alignas(kCacheLine) std::atomic<std::uint64_t> read_{0};
  std::uint64_t write_seen_ = 0;
  std::size_t read_index_ = 0;
};

}  // namespace hapticd::rt
