// The H-infinity norm of a stable system, with bounds on both sides.
//
// z = (1 + s)/(1 - s) maps the unit circle to the imaginary axis and keeps the norm:
//   Ac = (A + I)^-1 (A - I), Bc = sqrt(2) (A + I)^-1 B, Cc = sqrt(2) C (A + I)^-1, Dc = G(-1).
// For g > |Dc| the largest singular value is below g at all frequencies iff the Hamiltonian matrix
//   [ Ac + Bc R Dc' Cc,  g Bc R Bc' ;  -g Cc' Q Cc,  -(Ac + Bc R Dc' Cc)' ],
//   R = (g^2 I - Dc' Dc)^-1, Q = (g^2 I - Dc Dc')^-1
// has no imaginary eigenvalue; where it has, they are the frequencies at which a singular value
// crosses g. Between two crossings lies a larger value: the level rises to it (Boyd and Balakrishnan;
// Bruinsma and Steinbuch 1990), starting from a sweep over a grid that knows the poles.
#pragma once
#include "control/design/check/linear.h"

namespace hapticd::check {

struct Norm {
  double lower = 0;  ///< reached, at `angle`
  double upper = 0;  ///< (1 + tolerance) lower; infinity if the system is not stable or undecided
  double angle = 0;  ///< rad
};
/// NaN where an entry is not finite. `tolerance` relative, >= 1e-10.
Norm h_infinity(const System& g, double tolerance = 1e-7);

}  // namespace hapticd::check
