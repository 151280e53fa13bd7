// Ends a wait of the device's thread from any other: an eventfd, so that the thread waits for it beside its device.
#pragma once
#include <poll.h>

#include <cstdint>
#include <span>

namespace hapticd::usb {

/// CLOCK_MONOTONIC.
std::int64_t monotonic_ns() noexcept;
/// Until a descriptor has something, at most until then; or a signal came.
void wait_for(std::span<pollfd> descriptors, std::int64_t until_ns) noexcept;

class Waker {
 public:
  Waker();  ///< throws std::system_error where the process may have no more descriptors
  Waker(const Waker&) = delete;
  Waker& operator=(const Waker&) = delete;
  ~Waker();

  /// Any thread, the servo thread too: one system call that neither waits nor allocates.
  void wake() noexcept;
  /// Was it woken since the last take? However often, once.
  bool take() noexcept;
  pollfd descriptor() const noexcept { return {.fd = descriptor_, .events = POLLIN, .revents = 0}; }

 private:
  int descriptor_ = -1;
};

}  // namespace hapticd::usb
