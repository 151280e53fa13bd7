// Is the loop stable for all that it may be? Answers: no, with the worst case; sampled, so many frozen
// cases and their largest eigenvalue, which is no proof; proved for the whole box, by quadratic
// Lyapunov functions (common_lyapunov.h): one for all that may change from tick to tick, or one for
// each device and hand, which then must not change.
#pragma once
#include <cstdint>

#include "control/design/check/common_lyapunov.h"

namespace hapticd::check {

enum class Robust : std::uint8_t { no, sampled, proved_constant, proved };

/// Eigenvalues this near to 1 are taken for unstable ones: a scene that can be carried along has one
/// at 1, on either side of which rounding may put it.
inline constexpr double kStableBelow = 1 - 1e-9;

struct RobustAnswer {
  Robust kind = Robust::no;
  std::string why;  ///< "243 cases; largest eigenvalue 0.9612 at mass ..", or what proves it
  WorstCase worst;
  std::size_t cases = 0;
  CommonVerdict common;  ///< where there was a P
};

/// `P`: none, one for all, or one for each device and hand. `per_side`: cases along every side of the
/// box, at least 2.
RobustAnswer robust(const SampledLoop& loop, const LoopBox& box, const std::vector<Matrix>& P = {},
                    int per_side = 3);

}  // namespace hapticd::check
