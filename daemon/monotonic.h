// CLOCK_MONOTONIC, for everything in the daemon but the servo loop, which is given its time.
#pragma once
#include <time.h>

#include <cstdint>

namespace hapticd::daemon {

inline std::int64_t monotonic_ns() noexcept {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace hapticd::daemon
