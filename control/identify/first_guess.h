// A first guess of an axis' dynamics out of the data alone, by modulating functions (Shinbrot 1957):
// the equation of motion times a smooth bump phi that is 0 at both ends of a stretch of time,
// integrated by parts until no derivative of a measured quantity is left,
//
//   m int phi'' x - b int phi' x + c int phi sgn(x') - g int phi = int phi u(t - delay)
//
// is linear in m, b, c, g for a given delay, which is searched. The bump is sin^4, so sums over
// samples are as good as the integrals; the right side is exact, for u is held.
#pragma once
#include <optional>

#include "control/identify/motion.h"
#include "control/identify/record.h"

namespace hapticd::identify {

struct GuessOptions {
  double high_Hz = 0;          ///< highest frequency in the motion
  double longest_delay_s = 0;  ///< that is looked for
};

/// None: the axis hardly moved, or the record is shorter than some bumps.
std::optional<Dynamics> first_guess(const Record& record, const GuessOptions& options);

}  // namespace hapticd::identify
