// The guard that other tests rely on: it must be able to fail them.
#include "tests/support/heap_guard.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace hapticd::test {
namespace {

class HeapGuardTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!HeapGuard::available())
      GTEST_SKIP() << "heap calls cannot be counted under this sanitizer";
  }
};

// Compilers may leave out an allocation whose address nobody sees.
void* volatile seen = nullptr;

TEST_F(HeapGuardTest, CatchesNewAndDelete) {
  const HeapGuard guard;
  auto value = std::make_unique<double>(1);
  seen = value.get();
  EXPECT_EQ(guard.calls(), 1);
  value.reset();
  EXPECT_EQ(guard.calls(), 2);
}

TEST_F(HeapGuardTest, CatchesEveryEntrance) {
  const HeapGuard guard;
  long expected = 0;
  void* block = std::malloc(10);
  seen = block;
  EXPECT_EQ(guard.calls(), ++expected);
  block = std::realloc(block, 1000);
  seen = block;
  EXPECT_EQ(guard.calls(), ++expected);
  std::free(block);
  EXPECT_EQ(guard.calls(), ++expected);
  block = std::calloc(3, 5);
  seen = block;
  EXPECT_EQ(guard.calls(), ++expected);
  std::free(block);
  ++expected;
  block = std::aligned_alloc(64, 128);
  seen = block;
  EXPECT_EQ(guard.calls(), ++expected);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % 64, 0u);
  std::free(block);
}

TEST_F(HeapGuardTest, CatchesAContainerThatGrows) {
  std::vector<int> values;
  values.reserve(1);
  values.push_back(1);
  const HeapGuard guard;
  values.push_back(2);
  seen = values.data();
  EXPECT_GT(guard.calls(), 0);
}

TEST_F(HeapGuardTest, CountsNothingWhereNothingIsAllocated) {
  std::vector<int> values(10);
  const HeapGuard guard;
  for (int& value : values) value += 1;
  seen = values.data();
  EXPECT_EQ(guard.calls(), 0);
}

TEST_F(HeapGuardTest, LeavesOtherThreadsOut) {
  long calls = -1;
  std::thread other([&] {
    const HeapGuard guard;
    calls = guard.calls();
  });
  other.join();
  EXPECT_EQ(calls, 0);
}

}  // namespace
}  // namespace hapticd::test
