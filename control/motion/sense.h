// Raw values -> q, qd of every axis: unwrap, scale, backward difference.
//
//   d_k  = raw_k - raw_{k-1}, brought into [-modulus/2, modulus/2)
//   q_k  = unit_per_raw * sum(d) + offset
//   qd_k = (q_k - q_{k-1}) / T, never over missed ticks or samples: then 0
//
// Raw values are whole numbers as doubles, so the sum is exact up to 2^53 counts: the unwrap cannot
// drift. The first value is read as signed, so a counter that starts just below zero starts just
// below zero.
#pragma once
#include "control/core/findings.h"
#include "control/step.h"

namespace hapticd::control {

/// Updates state.axes. Reports input_not_finite, encoder_jump, velocity, sample_missing,
/// encoder_stuck.
void sense(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept;

}  // namespace hapticd::control
