// Margins of a wall in the sampled loop as it is (check/sampled_loop.h), by searches over one number
// each; every condition is a spectral radius below one in all of the given cases.
#pragma once
#include <optional>
#include <vector>

#include "control/design/check/loop_cases.h"
#include "control/design/synthesis/one_variable.h"

namespace hapticd::synthesis {

using check::LoopCase;
using check::SampledLoop;

/// A wall K x + B_c v that is rendered directly, but for its damper.
struct SampledWall {
  double stiffness_N_m = 0;
  std::optional<check::System> velocity{};  ///< estimator from x (loop_parts.h); nothing: v itself
  std::optional<control::ObserverPlan> observer{};
  double period_s = 1e-3;
};
SampledLoop loop_of(const SampledWall& wall, double damper_Ns_m);

/// B_c for which all cases are stable.
std::optional<Range> stable_dampers(const SampledWall& wall, const std::vector<LoopCase>& cases,
                                    const Scan& dampers = {});

/// Largest D so that m (1 + alpha Delta), b (1 + beta Delta) is stable for all |Delta| < D: the first
/// that is not, looked for from 0 in steps of 1/200 of the way and bisected. 0: the nominal loop is not stable.
/// At most where the mass would end, 1/alpha, and at most `limit`.
double largest_uncertainty(const SampledLoop& loop, const LoopCase& nominal, double alpha,
                           double beta, double limit = 100);

/// Largest K, to 1e-6 of it, for which some B_c of the scan makes all cases stable: 0 where none has.
/// Whatever is below it is taken to be stable for some B_c, too.
double largest_stiffness(const SampledWall& wall, const std::vector<LoopCase>& cases,
                         const Scan& stiffnesses, const Scan& dampers);

}  // namespace hapticd::synthesis
