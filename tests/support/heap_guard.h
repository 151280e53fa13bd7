// Counts the heap calls of one thread, so that "never allocates" is a test that can fail.
//
//   HeapGuard guard;
//   device.request(time);
//   EXPECT_EQ(guard.calls(), 0);
//
// malloc and its family are replaced in every test binary that links this (operator new ends there
// too). Under a sanitizer they are the sanitizer's: then nothing is counted and the test has to
// skip, aloud.
#pragma once

namespace hapticd::test {

class HeapGuard {
 public:
  HeapGuard() noexcept;
  HeapGuard(const HeapGuard&) = delete;
  HeapGuard& operator=(const HeapGuard&) = delete;

  /// Calls of malloc, calloc, realloc, free and the aligned ones on this thread since the guard was
  /// made.
  long calls() const noexcept;
  /// False: this build cannot count.
  static bool available() noexcept;

 private:
  long before_;
};

}  // namespace hapticd::test
