// Scripted failures of a device, by device time: which are on in a tick.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/options.h"

namespace hapticd::sim {

class Failures {
 public:
  /// A failure lasts from the first tick at or after `at_s` until `for_s` later, one tick at least.
  Failures(const std::vector<Failure>& failures, double period_s);

  /// Device time is now `tick` periods after the first tick.
  void move_to(std::int64_t tick) noexcept { tick_ = tick; }
  /// A failure of the whole device is on.
  bool on(FailureKind kind) const noexcept;
  /// A failure of this axis is on.
  bool on(FailureKind kind, std::size_t axis) const noexcept;
  /// How much too much this axis reports [m]; 0: no jump.
  double jump_m(std::size_t axis) const noexcept;
  /// Processor time [ns] to burn now; each `slow` says so once.
  std::int64_t take_burn_ns() noexcept;

 private:
  struct Window {
    Failure failure;
    std::int64_t begin = 0;
    std::int64_t end = 0;
    bool spent = false;
  };
  bool on(const Window& window) const noexcept {
    return window.begin <= tick_ && tick_ < window.end;
  }

  std::vector<Window> windows_;
  std::int64_t tick_ = -1;
};

}  // namespace hapticd::sim
