#include "control/rt/spsc_ring.h"

#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <thread>
#include <vector>

namespace hapticd::rt {
namespace {

struct Storage {
  explicit Storage(std::size_t slots, std::size_t slot_bytes)
      : words(slots * slot_bytes / 8), ring(std::as_writable_bytes(std::span(words)), slot_bytes) {}
  std::vector<std::uint64_t> words;
  SpscRing ring;
};

bool push(SpscRing& ring, std::uint64_t value) {
  std::byte* slot = ring.reserve();
  if (slot == nullptr) return false;
  for (std::size_t i = 0; i < ring.slot_bytes(); i += 8) std::memcpy(slot + i, &value, 8);
  ring.commit();
  return true;
}

/// The value in front; `torn` is set where the words of a slot differ.
std::uint64_t pop(SpscRing& ring, const std::byte* slot, bool& torn) {
  std::uint64_t first = 0;
  std::memcpy(&first, slot, 8);
  for (std::size_t i = 8; i < ring.slot_bytes(); i += 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, slot + i, 8);
    if (word != first) torn = true;
  }
  ring.pop();
  return first;
}

TEST(SpscRing, GivesBackWhatWentInInOrder) {
  Storage storage(4, 16);
  bool torn = false;
  std::uint64_t next_in = 0, next_out = 0;
  for (int round = 0; round < 10; ++round) {
    for (int i = 0; i < 3; ++i) ASSERT_TRUE(push(storage.ring, next_in++));
    while (const std::byte* slot = storage.ring.front())
      ASSERT_EQ(pop(storage.ring, slot, torn), next_out++);
  }
  EXPECT_EQ(next_out, next_in);
  EXPECT_FALSE(torn);
  EXPECT_EQ(storage.ring.dropped(), 0u);
}

TEST(SpscRing, EmptyHasNoFront) {
  Storage storage(2, 8);
  EXPECT_EQ(storage.ring.front(), nullptr);
}

TEST(SpscRing, FullKeepsTheOldAndCountsTheNew) {
  Storage storage(3, 8);
  bool torn = false;
  for (std::uint64_t i = 0; i < 3; ++i) ASSERT_TRUE(push(storage.ring, i));
  EXPECT_FALSE(push(storage.ring, 3));
  EXPECT_FALSE(push(storage.ring, 4));
  EXPECT_EQ(storage.ring.dropped(), 2u);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_EQ(pop(storage.ring, storage.ring.front(), torn), i);
  EXPECT_EQ(storage.ring.front(), nullptr);
  EXPECT_TRUE(push(storage.ring, 5));
  EXPECT_EQ(storage.ring.dropped(), 2u);
}

TEST(SpscRing, WithoutASlotEverythingIsDropped) {
  Storage storage(0, 8);
  EXPECT_FALSE(push(storage.ring, 1));
  EXPECT_EQ(storage.ring.front(), nullptr);
  EXPECT_EQ(storage.ring.dropped(), 1u);
}

TEST(SpscRingThreads, ReaderSeesWholeRecordsInOrderAndDropsAreCounted) {
  constexpr std::uint64_t kRecords = 200'000;
  Storage storage(16, 64);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t i = 0; i < kRecords; ++i) {
      if (!push(storage.ring, i)) std::this_thread::yield();
    }
    done.store(true, std::memory_order_release);
  });
  std::uint64_t seen = 0, next = 0;
  bool torn = false, disordered = false;
  for (;;) {
    const bool last = done.load(std::memory_order_acquire);
    while (const std::byte* slot = storage.ring.front()) {
      const std::uint64_t value = pop(storage.ring, slot, torn);
      if (value < next) disordered = true;
      next = value + 1;
      ++seen;
    }
    if (last) break;
    std::this_thread::yield();
  }
  writer.join();
  EXPECT_FALSE(torn);
  EXPECT_FALSE(disordered);
  EXPECT_EQ(seen + storage.ring.dropped(), kRecords);
  EXPECT_GT(seen, 0u);
}

}  // namespace
}  // namespace hapticd::rt
