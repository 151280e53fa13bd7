// Finds the P of a dissipation inequality (check/dissipation.h) by a Riccati equation, so that no
// semidefinite program is needed where P alone is unknown.
//
// The least P of M(P) >= 0 (the energy that can be got out of the system at most) is the stabilising
// solution of
//
//   P = A' P A + Y' Y + (S' - A' P B)(R - B' P B)^-1 (S - B' P A),
//
// and M(P) is singular there: nothing would be left for a check. So the inequality is solved with
// (1 - e) P and (1 - e) R in the place of the P and R that stand in its diagonal blocks: then
// M(P) >= e diag(P, R), a distance from the boundary that does not depend on units. Dividing by 1 - e
// brings it back to the form above. Directions that the supply does not see would get P = 0; a small
// multiple of a balanced identity is added to Y' Y for them.
//
// With X = -P and the cross term taken out,
//   X = F' X (I + G X)^-1 F + H,  F = A - B R^-1 S,  G = B R^-1 B' >= 0,  H = -Y' Y - S' R^-1 S <= 0,
// which doubling (Anderson 1978; Chu, Fan, Lin, Wang 2004) solves: H_k is minus the energy that can be
// got out within 2^k samples. While the inequality can hold I + G H_k has eigenvalues > 0 only; where
// it cannot, one of them crosses zero at some horizon: an answer without any tolerance on eigenvalues
// near the unit circle.
#pragma once
#include <optional>

#include "control/design/check/exact.h"

namespace hapticd::synthesis {

using check::Matrix;
using check::System;

/// A P that `check` has accepted, or why there is none: the inequality fails, or it holds by so
/// little that rounding decides.
struct StorageAnswer {
  std::optional<Matrix> P;
  std::string why;
  check::Verdict verdict;  ///< of the check, where there is a P
};

StorageAnswer find_storage(const check::Dissipation& inequality);
/// The same with what the checks prepare: their problem is the answer where there is one.
StorageAnswer find_storage(const check::Premises& premises);

/// For check::proves_positive_real.
StorageAnswer positive_real_certificate(const System& g, const Matrix& psi, double period_s);

}  // namespace hapticd::synthesis
