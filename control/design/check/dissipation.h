// One dissipation inequality, and the proof that a matrix P satisfies it. For x' = A x + B u,
//
//   |x'|^2_P - |x|^2_P <= 2 u' S x + u' R u - |Y x|^2        for all x, u
//
// is, with P > 0, the same as
//
//   M(P) = [ P - A' P A - Y' Y,  S' - A' P B ;  *,  R - B' P B ] >= 0                              (1)
//
// (|x|^2_P = x' P x is the storage, the right hand side what is supplied.) Where the corner
// P - A' P A is > 0 all eigenvalues of A lie inside the unit circle (Lyapunov), so that a proof of
// (1) with "> 0" proves stability too.
//
// How it is checked. P = L L' (Cholesky); in the coordinates L' x the storage is the identity and
// |A| <= 1 wherever (1) holds, so all terms are of order one whatever the units; inputs are scaled by
// powers of two until R is, too. Then M - delta I must have a Cholesky factor. delta bounds what
// rounding may have done on the way, term by term (no constant to be tuned): with u = 2^-53 a
// product of inner length n errs by at most n u |X| |Y| (entries of absolute values), a triangular
// solution L z = b by n u |L^-1| |L| |z|, a Cholesky factorisation by n u trace. Norms are
// Frobenius'. The bound is doubled for the terms of second order.
#pragma once
#include <string>

#include "control/design/check/linear.h"

namespace hapticd::check {

/// The answer of a check. `why` says in words what holds or which inequality fails, by how much.
struct Verdict {
  bool holds = false;
  std::string why;
  double margin = 0;  ///< by how much it holds; negative or NaN: it is not shown
};

struct Dissipation {
  Matrix A, B;  ///< n x n, n x m
  Matrix S, R;  ///< m x n, m x m (symmetric)
  Matrix Y;     ///< any x n; may have no rows
  /// What computing B, R and Y may have changed, entry by entry, same sizes; empty: exact.
  Matrix error_B, error_R, error_Y;
};

/// Is (1) true with ">"? Refuses P of wrong size, asymmetric, not finite or not > 0. The margin is
/// that of the scaled matrix, without unit: its smallest eigenvalue less delta.
Verdict proves(const Dissipation& inequality, const Matrix& P);

/// x = (I - A)^-1 B and G(1) = D + C x, with bounds of their rounding, entry by entry: from the
/// residual and the computed inverse.
struct Rest {
  Matrix x, error_x;
  Matrix gain, error_gain;  ///< gain is made symmetric if it is square
  /// Empty where G(1) is symmetric and >= 0 up to rounding: what is said afterwards is about the
  /// model whose G(1) is the nearest such matrix.
  std::string problem;
};
/// `g` is square; all entries finite.
Rest rest(const System& g);

/// Has a Cholesky factor, all of it finite. (Eigen's own answer lets NaN pass.)
bool positive_definite(const Matrix& m);

/// What is wrong with the sizes or entries of a square system; empty: nothing.
std::string malformed(const System& g);
/// The same of a symmetric matrix of size m: `name` is what it is called.
std::string malformed(const Matrix& symmetric, Eigen::Index m, const char* name);

}  // namespace hapticd::check
