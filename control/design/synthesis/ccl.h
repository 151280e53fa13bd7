// Theorem 4 of Bianchini, Orlandesi and Prattichizzo (2010): a coupling of a given form that makes
// the loop stable with any passive hand, by cone complementarity linearisation (El Ghaoui, Oustry,
// Ait Rami 1997). Unknown are (a, b, c, d) of coupling_form.h, P_E, Phi_E, Delta_V, Sigma, Q, Y.
// With k = (unit/2) Delta_D^-1,
//
//   Ah = [a, -b; 0, 0],  Bh = [b; I],  Ch = [c, k - d],  Dh = d - k                              (12)
//
// (14)      E-hat + Phi_E passive, with the integrators taken out (loop.h), and (10);
// (15)      [Y, R'; R, S] > 0, Lemma 2 (lmi_levels.h) linear in (a, b, c, d) because Q, Sigma and Y
//           stand for P^-1, Delta_V^-1 and Q^-1;
// (17)      Sigma = Delta_V^-1, Y = Q^-1, relaxed to  [W, I; I, Z] > 0  with W = diag(Sigma, Q),
//           Z = diag(Delta_V, Y)                                                                (18)
//
// Each step minimises trace(W_last Z + Z_last W); the first has W_last = Z_last = I. The relaxation
// has a strict interior, the limit has not: V-hat vanishes at z = 1, where (15) with (17) is
// singular. So no iterate is judged by (15)-(17) but by Theorem 3 on the coupling that it
// describes (theorem3.h), which takes that face out and is verified by Cholesky factorisations.
// W and Z are block diagonal, so (18) is two inequalities.
#pragma once
#include <functional>
#include <string>

#include "control/design/synthesis/coupling_form.h"
#include "control/design/synthesis/theorem3.h"

namespace hapticd::synthesis {

struct CclStep {
  int iteration = 0;           ///< from 1
  double objective = 0;        ///< trace(W_last Z + Z_last W), without unit
  double complementarity = 0;  ///< |W Z - I|, its largest singular value
  bool verified = false;       ///< this iterate passed Theorem 3
  double merit = 0;            ///< of the best verified so far; 0 where none is or none is asked
};

enum class Storages : std::uint8_t {
  full,    ///< as in the paper
  blocks,  ///< Q, Y, Sigma, Delta_V, Phi_E as blocks of the form: may miss couplings, but is fast
};

struct CclOptions {
  int max_iterations = 40;
  double tolerance = 1e-4;  ///< |W Z - I| at which the paper stops
  double shift = 1e-6;      ///< every inequality is solved with this much room
  double unit_Ns_m = 0;     ///< 0: the mean level of the devices
  Storages storages = Storages::full;
  /// Without: the first iterate that is verified is the answer. With: iterations go on, and the
  /// verified iterate of the smallest merit is.
  std::function<double(const DesignedCoupling&)> merit;
  /// After each step; false stops.
  std::function<bool(const CclStep&)> progress;
  SdpOptions solver{.gap = 1e-7};
};

struct CclDesign {
  bool found = false;
  DesignedCoupling coupling;
  Theorem3 proof;
  int iterations = 0;  ///< steps taken
  double merit = 0;
  std::string why;  ///< where none is found: infeasible, or not verified within the iterations
};

/// `form` covers the coordinates of the loop.
CclDesign design_by_ccl(const HapticLoop& loop, const Form& form, const CclOptions& options = {});

}  // namespace hapticd::synthesis
