#include "drivers/usb/waker.h"

#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

namespace hapticd::usb {

std::int64_t monotonic_ns() noexcept {
  timespec time;
  clock_gettime(CLOCK_MONOTONIC, &time);
  return std::int64_t{time.tv_sec} * 1'000'000'000 + time.tv_nsec;
}

void wait_for(std::span<pollfd> descriptors, std::int64_t until_ns) noexcept {
  const std::int64_t left_ns = std::max<std::int64_t>(0, until_ns - monotonic_ns());
  const timespec timeout{.tv_sec = static_cast<time_t>(left_ns / 1'000'000'000),
                         .tv_nsec = static_cast<long>(left_ns % 1'000'000'000)};
  (void)ppoll(descriptors.data(), descriptors.size(), &timeout, nullptr);
}

Waker::Waker() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
}

Waker::~Waker() {
  ::close(descriptor_);
}

void Waker::wake() noexcept {
  constexpr std::uint64_t kOne = 1;
  // It cannot fail but by a counter that is full, and so wakes already.
  [[maybe_unused]] const ssize_t written = ::write(descriptor_, &kOne, sizeof(kOne));
}

bool Waker::take() noexcept {
  std::uint64_t count = 0;
  return ::read(descriptor_, &count, sizeof(count)) == sizeof(count);
}

}  // namespace hapticd::usb
