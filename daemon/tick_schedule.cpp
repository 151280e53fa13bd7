#include "daemon/tick_schedule.h"

#include <algorithm>
#include <numeric>

namespace hapticd::daemon {
namespace {

/// Boot time and monotonic time are read one after the other; only more than this between them is a
/// suspend.
constexpr std::int64_t kSuspend_ns = 50'000'000;

}  // namespace

std::optional<Phase> phase_beyond(const std::array<std::int64_t, kPhases>& phase_ends,
                                  std::int64_t period_ns) noexcept {
  for (std::size_t phase = 0; phase < kPhases; ++phase) {
    if (phase_ends[phase] > period_ns) return static_cast<Phase>(phase);
  }
  return std::nullopt;
}

TickSchedule::TickSchedule(const TickScheduleOptions& options) noexcept : options_(options) {}

void TickSchedule::start(ClockPair now) noexcept {
  next_ns_ = now.monotonic_ns + options_.period_ns;
  next_tick_ = 0;
  last_monotonic_ns_ = now.monotonic_ns;
  sleep_offset_ns_ = now.boottime_ns - now.monotonic_ns;
  late_phase_ = Phase::wake;
  missed_.fill(0);
  newest_slice_ = now.monotonic_ns / kSlice_ns;
}

Wake TickSchedule::woke(ClockPair now) noexcept {
  Wake wake;
  wake.missed_ticks = std::max<std::int64_t>(0, (now.monotonic_ns - next_ns_) / options_.period_ns);
  wake.tick = next_tick_ + wake.missed_ticks;
  wake.start_ns = next_ns_ + wake.missed_ticks * options_.period_ns;
  wake.late_ns = now.monotonic_ns - wake.start_ns;
  wake.blamed = late_phase_;
  late_phase_ = Phase::wake;
  if (wake.missed_ticks > 0) book_missed(now.monotonic_ns, wake.missed_ticks);
  judge(now, wake);

  if (wake.fault.code == Fault::clock_jump) {  // start anew from the clock as it now is
    wake.start_ns = now.monotonic_ns;
    wake.late_ns = 0;
  }
  next_tick_ = wake.tick + 1;
  next_ns_ = wake.start_ns + options_.period_ns;
  last_monotonic_ns_ = now.monotonic_ns;
  sleep_offset_ns_ = now.boottime_ns - now.monotonic_ns;
  return wake;
}

void TickSchedule::judge(ClockPair now, Wake& wake) const noexcept {
  const auto blame = [&wake](Fault fault, double found, double allowed) {
    wake.fault = {.code = fault, .found = found, .allowed = allowed};
  };
  const auto seconds = [](std::int64_t ns) { return static_cast<double>(ns) * 1e-9; };
  const std::int64_t asleep_ns = now.boottime_ns - now.monotonic_ns - sleep_offset_ns_;
  const std::int64_t missed_per_s = wake.missed_ticks > 0 ? missed_in_last_second() : 0;
  if (now.monotonic_ns < last_monotonic_ns_) {
    blame(Fault::clock_jump, seconds(now.monotonic_ns - last_monotonic_ns_), 0);
  } else if (asleep_ns > kSuspend_ns) {
    blame(Fault::suspended, seconds(asleep_ns), 0);
  } else if (wake.missed_ticks > options_.max_gap_ticks) {
    blame(Fault::overrun, static_cast<double>(wake.missed_ticks), options_.max_gap_ticks);
  } else if (missed_per_s > options_.max_missed_per_s) {
    blame(Fault::missed_rate, static_cast<double>(missed_per_s), options_.max_missed_per_s);
  }
}

bool TickSchedule::finished(const std::array<std::int64_t, kPhases>& phase_ends) noexcept {
  const std::optional<Phase> late = phase_beyond(phase_ends, options_.period_ns);
  if (late) late_phase_ = *late;
  return late.has_value();
}

void TickSchedule::book_missed(std::int64_t now_ns, std::int64_t missed) noexcept {
  const std::int64_t slice = now_ns / kSlice_ns;
  const auto count = static_cast<std::int64_t>(kSlices);
  if (slice - newest_slice_ >= count || slice < newest_slice_) missed_.fill(0);
  for (std::int64_t old = newest_slice_ + 1; old <= slice && old - newest_slice_ < count; ++old) {
    missed_[static_cast<std::size_t>(old % count)] = 0;
  }
  newest_slice_ = slice;
  missed_[static_cast<std::size_t>(slice % count)] += missed;
}

std::int64_t TickSchedule::missed_in_last_second() const noexcept {
  return std::accumulate(missed_.begin(), missed_.end(), std::int64_t{0});
}

}  // namespace hapticd::daemon
