// Theorem 3 of Bianchini, Orlandesi and Prattichizzo (2010): the loop of loop.h is stable with any
// passive hand if there are symmetric Delta_V, Phi_E with V-hat Delta_V-OSP, E-hat + Phi_E passive,
//
//   [Delta_D - Phi_E, -Phi_E; -Phi_E, Delta_V - Phi_E] > 0                                       (10)
//
// With P_E, P_V as in loop.h both conditions are linear in Phi_E, Delta_V, so that
//
//   maximise t over P_E, Phi_E, P_V, Delta_V:  (10) - t I >= 0,  Delta_V <= cap I
//
// is one semidefinite program, and t, N s/m, the largest margin. The cap is needed because Delta_V
// grows without bound as a spring reaches 2 Delta_D/T, where V-hat passes nothing any more.
#pragma once
#include <string>
#include <vector>

#include "control/design/synthesis/loop.h"

namespace hapticd::synthesis {

struct Theorem3Options {
  double level_cap_Ns_m = 1e4;
  double gap = 1e-9;  ///< of the solver, relative
};

struct Theorem3 {
  bool decided = false;    ///< false: the solver did not find out; then `stable` is false too
  bool stable = false;     ///< margin > 0, and P_E, P_V, (10) verified by Cholesky factorisations
  double margin_Ns_m = 0;  ///< t; 0 where V-hat has no level or E-hat cannot be made passive
  Matrix Phi_E, Delta_V;   ///< with which it holds, N s/m
  /// For check::proves_positive_real with (E, Phi_E) and ((V - kappa)^-1, -Delta_V).
  Matrix P_E, P_V;
  /// Whose device limits the margin: share of each coordinate in dt/dDelta_D, at least 0, sum 1.
  /// Where V-hat has no level: 1 at the coordinate that is furthest off.
  std::vector<double> limits;
  std::string why;  ///< where it is not stable or not decided
};

Theorem3 theorem3(const HapticLoop& loop, const System& coupling,
                  const Theorem3Options& options = {});

/// The matrix of (10).
Matrix stability_matrix(const Matrix& device, const Matrix& phi, const Matrix& delta);

}  // namespace hapticd::synthesis
