// Coordinates in which small numbers are small: the balanced realisation of a stable system, whose
// two Gramians are one diagonal matrix, and the part of it that the transfer function shows.
//
//   Wc = A Wc A' + B B',   Wo = A' Wo A + C' C,   Wc = Wo = diag(s)
//
// States with s below `tolerance` times the largest, or times |D|, are left out; that changes G(z) on the unit
// circle by at most twice the sum of what is left out (Glover 1984), and a design is verified on
// the system as it was given.
#pragma once
#include <optional>

#include "control/design/check/linear.h"

namespace hapticd::synthesis {

/// Solution of X = A X A' + Q for a stable A, by doubling: X = sum of A^k Q A'^k.
check::Matrix discrete_lyapunov(const check::Matrix& a, const check::Matrix& q);

/// Is the smallest singular value more than `least` of the largest? No for what is not finite.
bool well_conditioned(const check::Matrix& square, double least);

/// Nothing where A is not stable or its Gramians are not finite numbers.
std::optional<check::System> balanced(const check::System& g, double tolerance = 1e-10);

/// G(z) = residue / (z - 1) + rest(z).
struct Integrators {
  check::Matrix residue;  ///< p x m; zero where there is none
  check::System rest;     ///< without eigenvalues at 1
};

/// Eigenvalues of A within `tolerance` (relative to |A - I|) of 1 are integrators; nothing where
/// they are not semisimple: a double integrator is not passive.
std::optional<Integrators> split_integrators(const check::System& g, double tolerance = 1e-9);

}  // namespace hapticd::synthesis
