// When the ticks are, and what a late one means. Pure: times come in as arguments, so that every
// case of the policy is tested in virtual time.
//
//   a wake-up ...
//     within its period           runs that tick
//     m whole periods late        runs the current one: the m between are missed, none caught up
//   and it is a fault when
//     m > max_gap_ticks                                          overrun
//     more than max_missed_per_s were missed in the last second  missed_rate
//     boot time ran on while monotonic time stood still          suspended
//     monotonic time ran backwards                               clock_jump
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "control/core/fault.h"
#include "daemon/servo_shared.h"

namespace hapticd::daemon {

struct TickScheduleOptions {
  std::int64_t period_ns = 1'000'000;
  int max_gap_ticks = 5;
  int max_missed_per_s = 20;
};

/// The two clocks at one moment.
struct ClockPair {
  std::int64_t monotonic_ns = 0;
  std::int64_t boottime_ns = 0;
};

/// One wake-up, judged.
struct Wake {
  std::int64_t tick = 0;
  std::int64_t start_ns = 0;  ///< of this tick's period
  std::int64_t late_ns = 0;   ///< after start_ns
  std::int64_t missed_ticks = 0;
  Phase blamed =
      Phase::wake;  ///< for missed ticks: the phase that was still running when the period ended
  FaultReport fault{};
};

/// The phase that was running when the period ended, if one was. Ends of the phases are relative to
/// the period's start [ns].
std::optional<Phase> phase_beyond(const std::array<std::int64_t, kPhases>& phase_ends,
                                  std::int64_t period_ns) noexcept;

class TickSchedule {
 public:
  explicit TickSchedule(const TickScheduleOptions& options) noexcept;

  /// Tick 0 starts one period after `now`.
  void start(ClockPair now) noexcept;
  /// Absolute CLOCK_MONOTONIC time of the next tick.
  std::int64_t next_ns() const noexcept { return next_ns_; }
  /// The thread woke up for the tick at next_ns().
  Wake woke(ClockPair now) noexcept;
  /// The tick's work is done; ends of its phases relative to the period's start [ns]. True: it
  /// ended after its period.
  bool finished(const std::array<std::int64_t, kPhases>& phase_ends) noexcept;

 private:
  void judge(ClockPair now, Wake& wake) const noexcept;
  void book_missed(std::int64_t now_ns, std::int64_t missed) noexcept;
  std::int64_t missed_in_last_second() const noexcept;

  /// The last second, in hundredths: how many ticks were missed in each.
  static constexpr std::size_t kSlices = 100;
  static constexpr std::int64_t kSlice_ns = 10'000'000;

  TickScheduleOptions options_;
  std::int64_t next_ns_ = 0;
  std::int64_t next_tick_ = 0;
  std::int64_t last_monotonic_ns_ = 0;
  std::int64_t sleep_offset_ns_ =
      0;  ///< boottime - monotonic: grows only while the machine is suspended
  Phase late_phase_ = Phase::wake;
  std::array<std::int64_t, kSlices> missed_{};
  std::int64_t newest_slice_ = 0;
};

}  // namespace hapticd::daemon
