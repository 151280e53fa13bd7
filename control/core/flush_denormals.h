// Flush-to-zero and denormals-are-zero for as long as the guard lives: a subnormal operand costs
// about a hundred times a normal one, and a filter at rest decays into them. Cycle::run holds one,
// so every caller of step() computes the same bits.
#pragma once
#include <cstdint>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace hapticd {

class FlushDenormals {
 public:
  FlushDenormals() noexcept : saved_(read()) {
    if ((saved_ & kBits) != kBits) write(saved_ | kBits);
  }
  ~FlushDenormals() {
    if ((saved_ & kBits) != kBits) write(saved_);
  }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
#if defined(__x86_64__)
  using Word = unsigned int;
  static constexpr Word kBits = 0x8040;  // MXCSR: FTZ | DAZ
  static Word read() noexcept {
    return _mm_getcsr();
  }
  static void write(Word word) noexcept {
    _mm_setcsr(word);
  }
#elif defined(__aarch64__)
  using Word = std::uint64_t;
  static constexpr Word kBits = Word{1} << 24;  // FPCR: FZ
  static Word read() noexcept {
    Word word;
    asm volatile("mrs %0, fpcr" : "=r"(word));
    return word;
  }
  static void write(Word word) noexcept {
    asm volatile("msr fpcr, %0" ::"r"(word));
  }
#else
#error "say here how this processor flushes subnormal numbers to zero"
#endif
  const Word saved_;
};

}  // namespace hapticd
