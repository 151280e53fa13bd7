// The haptic loop of Bianchini, Orlandesi and Prattichizzo (2010), section 2, for any number of
// contacts: m coordinates of all contacts together, and the loop transformation that Theorems 2 to
// 4 speak of. Signals: displacement m, force N, period s; levels N s/m.
//
//   V-hat = (z-1)/(Tz) (V - kappa),   E-hat = Tz/(z-1) E,   kappa = (T/2) Delta_D^-1        (7), (8)
//
// The integrator of E-hat in closed form, G1 = G(1):
//
//   Tz/(z-1) G = (T/2) G1 (z+1)/(z-1) + R,   R = (A, -T A (I-A)^-1 B, C, T D - (T/2) G1)
//
// because G - G1 = -(z-1) C (zI-A)^-1 (I-A)^-1 B and z (zI-A)^-1 = I + A (zI-A)^-1. (z+1)/(z-1) is
// imaginary on the unit circle: Tz/(z-1) G + Psi is positive real iff G1 = G1' >= 0, A is stable
// and R + Psi is positive real. R has no pole at 1: nothing is lost and nothing is nudged.
// V-hat is Delta_V-OSP iff V-hat^-1 - Delta_V = Tz/(z-1) (V - kappa)^-1 - Delta_V is positive real:
// one inequality serves scene and coupling.
#pragma once
#include <vector>

#include "control/design/check/linear.h"
#include "control/design/check/spring_damper.h"

namespace hapticd::synthesis {

using check::Matrix;
using check::spring_damper;
using check::System;

struct HapticLoop {
  System scene;         ///< E: displacement to force, m x m, N/m; |eigenvalues of A| < 1
  Matrix device_level;  ///< Delta_D, m x m, symmetric > 0
  double period_s = 1e-3;
};

/// Theorem 1: the levels of devices side by side, (6).
Matrix device_level(const std::vector<Matrix>& devices);

/// E-hat and V-hat of (7), (12), for Lemmas 1 and 2.
System transformed_scene(const System& scene, double period_s);
System transformed_coupling(const System& coupling, const HapticLoop& loop);

/// kappa of (8), m/N.
Matrix half_compliance(const HapticLoop& loop);

/// (V - kappa)^-1, N/m: what V-hat^-1 is made of. D_V - kappa regular.
System backed_off_inverse(const System& coupling, const HapticLoop& loop);

/// R above. 1 is no eigenvalue of A.
System without_integrator(const System& g, double period_s);

}  // namespace hapticd::synthesis
