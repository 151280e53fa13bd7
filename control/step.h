// The tick. step(plan, state, input) is a pure function of its arguments: the daemon, the
// simulator, the benchmarks and replay call the same one.
#pragma once
#include <cstdint>
#include <span>

#include "control/core/fault.h"
#include "control/core/realtime.h"
#include "control/core/sample.h"
#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

struct TickInput {
  std::int64_t tick = 0;          ///< number of the period since the loop started
  std::int64_t missed_ticks = 0;  ///< periods skipped just before this one
  FaultReport host_fault{};  ///< seen by the caller (e-stop, overrun, ...); none in a healthy tick
  bool enable = false;       ///< forces are wanted
  bool clear_fault = false;  ///< an operator leaves the fault; ignored while its cause stands
  bool unproven = false;     ///< forces are wanted without a proof of stability; only recorded
  std::span<const AxisSample> axes;  ///< plan.axes.size() samples
  std::span<const Aux> aux;          ///< plan.devices.size()
  std::span<const double>
      delivered;  ///< N or N m, what the devices carried of the last tick's efforts
};

struct TickOutput {
  std::span<const double>
      effort;  ///< N or N m, plan.axes.size(); lives in the state until the next tick
  Mode mode = Mode::idle;
  LimitFlags limits;
  FaultReport fault;  ///< the first since it was last cleared
};

/// One tick. Never throws, allocates, blocks or reads a clock; finite or not, any input gives a
/// bounded output.
TickOutput step(const Plan& plan, State& state,
                const TickInput& input) noexcept HAPTICD_NONBLOCKING;

/// Hands the motion state, force and mode of `from` to `to` when a plan is swapped under a running
/// loop. Both plans have the same devices, axes and kinematics in the same order (the supervisor
/// refuses any other reload).
void carry_over(const Plan& from_plan, const State& from, const Plan& to_plan,
                State& to) noexcept HAPTICD_NONBLOCKING;

}  // namespace hapticd::control
