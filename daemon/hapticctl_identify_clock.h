// When the ticks of an identification are: at once for a simulated device, by the clock of the
// machine for a real one. All else is the same code.
#pragma once
#include <cstdint>

#include "daemon/tick_schedule.h"
#include "drivers/device.h"

namespace hapticd::daemon {

class TickClock {
 public:
  TickClock() = default;
  TickClock(const TickClock&) = delete;
  TickClock& operator=(const TickClock&) = delete;
  virtual ~TickClock() = default;

  /// Waits for the next tick. After a late one `missed` ticks lie between it and the one before.
  struct Tick {
    drivers::TickTime time;
    std::int64_t missed = 0;
  };
  virtual Tick next() noexcept = 0;
  virtual std::int64_t now_ns() const noexcept = 0;
};

/// Time stands still within a tick.
class VirtualClock final : public TickClock {
 public:
  explicit VirtualClock(std::int64_t period_ns) noexcept : period_ns_(period_ns) {}
  Tick next() noexcept override;
  std::int64_t now_ns() const noexcept override { return now_ns_; }

 private:
  std::int64_t period_ns_;
  std::int64_t tick_ = 0;
  std::int64_t now_ns_ = 0;
};

/// CLOCK_MONOTONIC, by the rules of the servo thread.
class MonotonicClock final : public TickClock {
 public:
  explicit MonotonicClock(const TickScheduleOptions& options) noexcept;
  Tick next() noexcept override;
  std::int64_t now_ns() const noexcept override;

 private:
  std::int64_t period_ns_;
  TickSchedule schedule_;
};

}  // namespace hapticd::daemon
