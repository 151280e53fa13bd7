#include "tests/support/heap_guard.h"

#include <cerrno>
#include <cstddef>
#include <cstdint>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define HAPTICD_HEAP_COUNTED 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || \
    __has_feature(memory_sanitizer) || __has_feature(realtime_sanitizer)
#define HAPTICD_HEAP_COUNTED 0
#endif
#endif
#if !defined(HAPTICD_HEAP_COUNTED) && defined(__GLIBC__)
#define HAPTICD_HEAP_COUNTED 1
#endif
#ifndef HAPTICD_HEAP_COUNTED
#define HAPTICD_HEAP_COUNTED 0
#endif

namespace {

thread_local long heap_calls = 0;  // of the executable itself: reading it allocates nothing

}  // namespace

#if HAPTICD_HEAP_COUNTED
// glibc exports its own allocator under these names for replacements that only look on.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);

void* malloc(std::size_t size) noexcept {
  ++heap_calls;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++heap_calls;
  return __libc_calloc(count, size);
}
void* realloc(void* pointer, std::size_t size) noexcept {
  ++heap_calls;
  return __libc_realloc(pointer, size);
}
void free(void* pointer) noexcept {
  ++heap_calls;
  __libc_free(pointer);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++heap_calls;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  ++heap_calls;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** pointer, std::size_t alignment, std::size_t size) noexcept {
  ++heap_calls;
  void* const block = __libc_memalign(alignment, size);
  if (block == nullptr) return ENOMEM;
  *pointer = block;
  return 0;
}
}  // extern "C"
#endif

namespace hapticd::test {

HeapGuard::HeapGuard() noexcept : before_(heap_calls) {}
long HeapGuard::calls() const noexcept {
  return heap_calls - before_;
}
bool HeapGuard::available() noexcept {
  return HAPTICD_HEAP_COUNTED != 0;
}

}  // namespace hapticd::test
