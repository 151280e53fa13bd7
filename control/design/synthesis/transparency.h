// How far the user feels the coupling instead of the scene (Bianchini, Orlandesi, Prattichizzo 2010, section
// 5): with F = (I + E V)^-1 E what is felt of the scene E through the coupling V,
//   loop shaping (24), (25)   |W1 E V W2|,        without unit: small where F is near E
//   closed loop (23)          |W1 (F - E) W2|,    N/m
// as H-infinity norms. All systems are in z: E is the scene as it runs, and a norm does not ask for
// a minimal realisation, so nothing is gained by joining weight and scene in s first.
#pragma once
#include "control/design/check/h_infinity.h"

namespace hapticd::synthesis {

using check::System;

struct Weights {
  System left, right;  ///< W1, W2: m x m, stable
};
/// Both weights the identity.
Weights unweighted(Eigen::Index m);
/// Backward Euler of 1/(1 + s/corner), on each of m coordinates.
System low_pass(double corner_rad_s, double period_s, Eigen::Index m);

check::Norm loop_shaping_norm(const System& scene, const System& coupling, const Weights& weights);
check::Norm closed_loop_norm(const System& scene, const System& coupling, const Weights& weights);

}  // namespace hapticd::synthesis
