// The energy ledger: work that the motors of each device did on it [J], booked on what was
// delivered, over the period that has just ended (derivation and error bound in ledger.cpp):
//
//   W += sum over axes of [(1 - t/T) u_{k-n} + (t/T) u_{k-n-1}] (q_{k+1} - q_k),  latency = n T + t
//
// It is exact for t = 0; else its error in one tick is at most |u_{k-n} - u_{k-n-1}| a t (T - t)/2
// with a the largest acceleration. Over missed ticks the last effort was held.
#pragma once
#include <array>
#include <cstdint>

#include "control/core/capacity.h"

namespace hapticd::control {

struct Plan;
struct State;
struct TickInput;

/// Delivered efforts of an axis by age in ticks: delivered[0] came with this tick's input.
struct DeliveredState {
  std::array<double, kMaxDelayTicks + 2> delivered{};
  double q = 0;        ///< m or rad: of the tick before
  bool known = false;  ///< q is
};

/// Books the period that has just ended: state.work. Runs before forward(), as the
/// Jacobians still are those that the efforts were made with: contact-space observers get the force
/// that was delivered from here, and passivity controllers what the contact force did.
void book(const Plan& plan, State& state, const TickInput& input) noexcept;

}  // namespace hapticd::control
