#include "daemon/hapticctl_identify_clock.h"

#include <time.h>

#include <array>
#include <cerrno>

#include "daemon/monotonic.h"

namespace hapticd::daemon {
namespace {

ClockPair both_clocks() noexcept {
  timespec boot{};
  ::clock_gettime(CLOCK_BOOTTIME, &boot);
  return {monotonic_ns(), std::int64_t{boot.tv_sec} * 1'000'000'000 + boot.tv_nsec};
}

}  // namespace

TickClock::Tick VirtualClock::next() noexcept {
  now_ns_ = tick_ * period_ns_;
  return {.time = {.tick = tick_++, .start_ns = now_ns_, .deadline_ns = now_ns_}};
}

MonotonicClock::MonotonicClock(const TickScheduleOptions& options) noexcept
    : period_ns_(options.period_ns), schedule_(options) {
  schedule_.start(both_clocks());
}

/// Samples are waited for as long as any device may take: efforts then still go out within the period.
TickClock::Tick MonotonicClock::next() noexcept {
  const std::int64_t at_ns = schedule_.next_ns();
  const timespec at{.tv_sec = static_cast<time_t>(at_ns / 1'000'000'000),
                    .tv_nsec = static_cast<long>(at_ns % 1'000'000'000)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, nullptr) == EINTR) {
  }
  const Wake wake = schedule_.woke(both_clocks());
  return {.time = {.tick = wake.tick,
                   .start_ns = wake.start_ns,
                   .deadline_ns = wake.start_ns + period_ns_ * 4 / 5},
          .missed = wake.missed_ticks};
}

std::int64_t MonotonicClock::now_ns() const noexcept {
  return monotonic_ns();
}

}  // namespace hapticd::daemon
