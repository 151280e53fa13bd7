// Transparency by H-infinity loop shaping within the couplings of Theorem 4 (Bianchini, Orlandesi,
// Prattichizzo 2010, section 5): make the largest singular value over frequency of
//
//   L = W1 E V W2                                                                           (24), (25)
//
// small. L is linear in (a, b, c, d) of V, so with M = W1 E (T/unit) / gamma_0 = (A1, B1, C1, D1)
//
//   A = [A1, B1 c, B1 d C2; 0, a, b C2; 0, 0, A2],  B = [B1 d D2; b D2; B2],
//   C = [C1, D1 c, D1 d C2],  D = D1 d D2
//
// and |L| < gamma_0 sqrt(g) iff, for some X > 0 and Xi = X^-1 (bounded real lemma, Schur complement),
//
//   [Xi, 0, A', C'; *, I, B', D'; *, *, X, 0; *, *, *, g I] > 0.
//
// Xi = X^-1 is one more complementary pair. Bisecting over g with a feasibility problem each is poor:
// the iterates crawl. Here g is a variable with a price: minimise traces + penalty g. The relaxed g
// says little, so each iterate is judged by the norm of its own L and by Theorem 3.
//
// gamma_0 is the norm with V = kappa, the limit of springs: at rest no coupling of the class is
// stiffer (V-hat passive asks for V(1) >= kappa), so it is the scale of what can be reached.
#pragma once
#include "control/design/synthesis/ccl.h"

namespace hapticd::synthesis {

struct LoopShaping {
  System W1, W2;                              ///< stable; m columns, m rows
  std::function<double(const System&)> norm;  ///< the H-infinity norm of a stable system
  /// Of g against the traces: the larger, the nearer to the least norm, until digits run out.
  double penalty = 3e7;
  /// Iterations without an improvement of 1e-4 after which it ends.
  int patience = 25;
};

/// W1 E V W2.
System shaped_loop(const LoopShaping& shaping, const HapticLoop& loop, const System& coupling);

/// `options.merit` is not used: the merit of the design is the norm of its shaped loop.
CclDesign design_transparent(const HapticLoop& loop, const Form& form, const LoopShaping& shaping,
                             const CclOptions& options = {});

}  // namespace hapticd::synthesis
