// A program that ticks in memory, for `hapticctl cost`: the daemon's own Cycle, record included,
// with devices that go along a short walk over and over. No clock is read inside a tick.
#pragma once
#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "daemon/cycle.h"

namespace hapticd::daemon {

inline constexpr std::size_t kWalkTicks = 20;

/// Raw value of every axis of the plan, for each tick of a walk that is gone over and over.
using Walk = std::array<std::vector<double>, kWalkTicks>;

/// Where a walk is in its i-th tick: to and fro between -1 and 1 in steps of 0.2.
double walked(std::size_t i) noexcept;

/// Fresh samples along a walk, armed, referenced, its dead-man held.
class WalkingDevice;

/// Not movable: the cycle points into it.
class CostRig {
 public:
  /// Every axis stands at raw value 0 until walk() says otherwise.
  explicit CostRig(build::ProgramSpec spec);
  ~CostRig();
  CostRig(const CostRig&) = delete;
  CostRig& operator=(const CostRig&) = delete;

  void walk(const Walk& walk);
  /// So many ticks, forces on.
  void run(std::size_t ticks) noexcept;

  const build::Program& program() const noexcept { return program_; }
  build::Program& program() noexcept { return program_; }
  /// Forces were on in the last tick.
  bool enabled() const noexcept { return cycle_->output().mode == control::Mode::enabled; }
  FaultReport fault() const noexcept { return cycle_->output().fault; }

 private:
  build::Program program_;
  std::vector<std::unique_ptr<WalkingDevice>> devices_;
  std::unique_ptr<Cycle> cycle_;
  std::vector<std::uint64_t> slot_;  // a ring of one record, emptied every tick
  rt::SpscRing ring_;
  CycleInput input_;
};

}  // namespace hapticd::daemon
