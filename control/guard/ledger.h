// The energy ledger: work that the motors of each device did on it [J], booked on what was
// delivered, over the period that has just ended:
//
//   W += sum over axes of [(1 - t/T) u_{k-n} + (t/T) u_{k-n-1}] (q_{k+1} - q_k),  latency = n T + t
//
// Exact for t = 0. Else, with e = u_{k-n} - u_{k-n-1} and s the way covered in the first t of the
// period, the error is e (s - (t/T) (q_{k+1} - q_k)), and as |s - (t/T) dq| <= a t (T - t) / 2 for an
// acceleration of at most a, it is at most |e| a t (T - t) / 2. The encoder adds at most one count
// times the change of the effort in every tick.
//
// Over missed ticks the last effort was held; over samples that did not come the mean of what was
// delivered is booked on the way covered, when a sample comes.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"

namespace hapticd::control {

struct AxisPlan;
struct Plan;
struct State;
struct TickInput;

/// Efforts of an axis on their way to becoming work.
struct HeldEffort {
  std::array<double, kMaxDelayTicks + 2> delivered{};  ///< by age in ticks
  double sum = 0;           ///< N or N m: of the efforts in force since the last fresh sample
  std::uint32_t ticks = 0;  ///< how many are in the sum
};

struct LedgerState {
  HeldEffort effort;
  double q = 0;                   ///< m or rad: at the last fresh sample
  double moved = 0;               ///< m or rad: by which q changed this tick
  std::uint32_t moved_ticks = 0;  ///< in so many ticks; 0: there was no fresh sample
  bool known = false;             ///< q is
};

/// Books the period that has just ended: state.work, and what the contact force did, for passivity
/// controllers. Fills state.contact_delivered for contact observers. Runs before forward(), as the
/// Jacobians still are those that the efforts were made with.
void book(const Plan& plan, State& state, const TickInput& input) noexcept;

}  // namespace hapticd::control
