// The loops that a loop may be: boxes of devices, hands, latencies and contact, and what sampling them
// says. Cases that were tried are no proof of those between (common_lyapunov.h has one), and frozen
// cases none of a contact that opens and closes: an answer from them says how many they were.
//
// A share of contact between 0 and 1 stands for a wall that gives way, seen from its surface: so for
// hands that rest at the surface or outside. About a place inside, to which a hand presses, leaving a
// wall with a damper is no such share.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "control/design/check/sampled_loop.h"

namespace hapticd::check {

/// low <= high, finite.
struct Side {
  double low = 0, high = 0;
};
struct LoopBox {
  Side mass_kg{}, damping_Ns_m{};
  Side hand_kg{}, hand_Ns_m{}, hand_N_m{};
  Side latency_s{};
  Side contact{1, 1};  ///< {0, 1}: the contact may be open, or give way by any share
};
std::string malformed(const SampledLoop& loop, const LoopBox& box);

/// The vertices, and with `per_side` > 2 as many values along every side; sides without length have
/// one. Not more than per_side^7 of them.
std::vector<LoopCase> cases_of(const LoopBox& box, int per_side = 2);

/// The device's mass and damping times 1 + alpha Delta and 1 + beta Delta, the paper's (13).
std::vector<LoopCase> scaled_devices(const LoopCase& one, double alpha, double beta,
                                     const std::vector<double>& deltas);

/// "mass 0.005 kg, damping 0.011 N s/m, hand 0.1 kg, contact open, latency 250 us".
std::string described(const LoopCase& one);

struct WorstCase {
  double radius = 0;  ///< the largest of all; NaN where a case is malformed
  LoopCase at;
};
WorstCase worst_of(const SampledLoop& loop, const std::vector<LoopCase>& cases);
/// The same as a yes or no, which may end at the first no.
bool all_stable(const SampledLoop& loop, const std::vector<LoopCase>& cases);

}  // namespace hapticd::check
