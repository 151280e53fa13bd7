#include "control/rt/latest.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <vector>

namespace hapticd::rt {
namespace {

struct Sample {
  std::array<std::uint64_t, 9> words{};
  std::uint8_t tail = 0;  // a size that is not a multiple of a word
};

Sample sample(std::uint64_t value) {
  Sample s;
  s.words.fill(value);
  s.tail = static_cast<std::uint8_t>(value);
  return s;
}

bool whole(const Sample& s) {
  for (const std::uint64_t word : s.words) {
    if (word != s.words[0]) return false;
  }
  return s.tail == static_cast<std::uint8_t>(s.words[0]);
}

TEST(Latest, IsEmptyUntilTheFirstStoreAndLeavesTheValueAlone) {
  const Latest<Sample> slot;
  Sample value = sample(7);
  EXPECT_FALSE(slot.load(value));
  EXPECT_EQ(value.words[0], 7u);
  EXPECT_EQ(slot.count(), 0u);
}

TEST(Latest, NewestWins) {
  Latest<Sample> slot;
  slot.store(sample(1));
  slot.store(sample(2));
  Sample value;
  ASSERT_TRUE(slot.load(value));
  EXPECT_TRUE(whole(value));
  EXPECT_EQ(value.words[0], 2u);
  EXPECT_EQ(slot.count(), 2u);
  ASSERT_TRUE(slot.load(value)) << "reading takes nothing away";
}

/// What a reader may see: whole values that never go back.
struct Seen {
  std::uint64_t loads = 0, last = 0;
  bool torn = false, backwards = false;
};

void read(const Latest<Sample>& slot, const std::atomic<bool>& done, Seen& seen) {
  while (!done.load(std::memory_order_acquire)) {
    Sample value;
    if (!slot.load(value)) {
      std::this_thread::yield();
      continue;
    }
    seen.torn = seen.torn || !whole(value);
    seen.backwards = seen.backwards || value.words[0] < seen.last;
    seen.last = value.words[0];
    ++seen.loads;
  }
}

TEST(LatestThreads, ReadersSeeOnlyWholeValuesThatNeverGoBack) {
  constexpr std::uint64_t kStores = 150'000;
  Latest<Sample> slot;
  slot.store(sample(0));
  std::atomic<bool> done{false};
  std::array<Seen, 2> seen;
  std::thread a([&] { read(slot, done, seen[0]); });
  std::thread b([&] { read(slot, done, seen[1]); });
  for (std::uint64_t i = 1; i <= kStores; ++i) {
    slot.store(sample(i));
    if (i % 64 == 0) std::this_thread::yield();
  }
  done.store(true, std::memory_order_release);
  a.join();
  b.join();
  for (const Seen& s : seen) {
    EXPECT_FALSE(s.torn);
    EXPECT_FALSE(s.backwards);
  }
  EXPECT_GT(seen[0].loads + seen[1].loads, 0u);
  Sample last;
  ASSERT_TRUE(slot.load(last));
  EXPECT_EQ(last.words[0], kStores);
}

// The words of a slot are atomic, so ThreadSanitizer sees no race in them whatever their order. It
// does see one here if a load does not come after all that went before the store.
TEST(LatestThreads, AValueBringsAlongAllThatWasWrittenBeforeIt) {
  constexpr std::uint64_t kStores = 20'000;
  Latest<std::uint64_t> slot;
  std::vector<std::uint64_t> plain(kStores + 1);
  std::uint64_t wrong = 0;
  std::thread reader([&] {
    for (std::uint64_t value = 0; value < kStores;) {
      if (!slot.load(value)) std::this_thread::yield();
      if (value != 0 && plain[value] != value + 1) ++wrong;
    }
  });
  for (std::uint64_t i = 1; i <= kStores; ++i) {
    plain[i] = i + 1;
    slot.store(i);
    if (i % 64 == 0) std::this_thread::yield();
  }
  reader.join();
  EXPECT_EQ(wrong, 0u);
}

}  // namespace
}  // namespace hapticd::rt
