// The dynamics of an axis that fit a record best, and how well they are known.
//
// Output error: positions that the exact sampled model (motion.h) predicts from the efforts alone
// against those measured, least squares by Levenberg and Marquardt over mass, viscous and Coulomb
// friction, delay, constant force, and where each window starts. With white measurement noise that
// is maximum likelihood.
//
// Windows' starts are fitted within each evaluation, so that only the shared parameters are searched
// (variable projection, Golub, Pereyra 1973).
//
// Half-widths of the 99 % intervals have two parts, added as squares:
// - with g_w the gradient of the sum of squares of window w after its start has been eliminated, and
//   S the sum of the windows' information, the covariance is S^-1 (sum g_w g_w') S^-1 (White 1980;
//   Liang, Zeger 1986, windows as clusters). It holds for coloured noise, quantisation and friction
//   that scatters, as long as windows do not depend on each other. Where the same by groups of
//   windows, or sigma^2 S^-1, is larger, that counts. Student's quantile has the degrees of freedom that the windows' shares leave
//   (Satterthwaite), for few windows may carry most of a parameter.
// - what no more data would tell: when exactly friction turns round after the motion has. It is
//   considered, not fitted: up to a tenth of a period early or late, by whatever sign in each window
//   is worst.
#pragma once
#include <functional>

#include "control/core/result.h"
#include "control/identify/motion.h"
#include "control/identify/record.h"

namespace hapticd::identify {

struct FitOptions {
  double high_Hz = 0;          ///< highest frequency in the motion, > 0
  double longest_delay_s = 0;  ///< that is looked for
  double window_s = 0.15;
  /// Asked before each step of the search; false ends it.
  std::function<bool(int iteration)> proceed{};
};

struct Fit {
  Dynamics value;
  Dynamics half_width;      ///< of the 99 % interval, parameter by parameter
  double residual = 0;      ///< root mean square, m or rad
  std::size_t windows = 0;  ///< that the intervals rest on
  int iterations = 0;
};

/// Errors (no): too short, the axis hardly moved, no convergence; try_again: told not to proceed.
Result<Fit> fit(const Record& record, const FitOptions& options);

}  // namespace hapticd::identify
