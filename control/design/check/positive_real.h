// The certificate template: is  H(z) = T z/(z-1) G(z) + Psi  positive real?
//
// H is what G is between velocity and force where G is between displacement and force, plus a
// constant: Psi = Phi_E for a scene E that needs the level Phi_E of input passivity, Psi = -Delta_V
// for the inverse of a coupling with that level of output passivity (Bianchini, Orlandesi, Prattichizzo
// 2010, Lemmas 1 and 2, whose inequalities have no strictly feasible point because H has a pole at
// z = 1). That pole is taken out in closed form: with G1 = G(1), x = (I - A)^-1 B,
//
//   (z I - A)^-1 - (I - A)^-1 = -(z - 1) (z I - A)^-1 (I - A)^-1
//   z (z I - A)^-1 = I + A (z I - A)^-1
//
// give  T z/(z-1) G = T z/(z-1) G1 + T (D - G1) + C (z I - A)^-1 Bh,   Bh = -T A x = -T (x - B).
// On the unit circle z/(z-1) = 1/2 + (a purely imaginary number), and T G1 (z+1)/(2 (z-1)) is
// lossless with the storage |p|^2 / 2 in the inverse of T G1 if G1 is symmetric and >= 0, which is
// also necessary (the residue of a positive real function at a pole on the circle). What is left is
//
//   C (z I - A)^-1 Bh + T D - (T/2) G1 + Psi                                                       (1)
//
// with all poles inside the circle, positive real iff some P >= 0 makes
//
//   [ P - A' P A,  C'/2 - A' P Bh ;  *,  T He D - (T/2) G1 + Psi - Bh' P Bh ] >= 0     (He X = (X + X')/2)
//
// (the storage x' P x of (1), supply u' y). Strict feasibility is now possible; stability of A
// follows from the first block.
#pragma once
#include "control/design/check/dissipation.h"

namespace hapticd::check {

/// A proof that H is positive real: `P` of the order of `g`. psi symmetric, in units of T G(z).
/// Refuses what is malformed, G(1) asymmetric or with a negative eigenvalue.
Verdict proves_positive_real(const System& g, const Matrix& psi, const Matrix& P, double period_s);

/// The inequality that is proved; `problem` if there is none.
struct Premises {
  Dissipation inequality;
  std::string problem;
};
Premises positive_real_premises(const System& g, const Matrix& psi, double period_s);

/// Smallest eigenvalue of He H over all frequencies, by a sweep; -infinity if G is not stable or
/// G(1) not symmetric >= 0, NaN if malformed. With psi = 0 it is minus the level Phi_E of a scene
/// (its smallest multiple of the identity), and the level Delta_V of a coupling when g is (V -
/// (T/2) Delta^-1)^-1.
double positive_real_margin(const System& g, const Matrix& psi, double period_s);

/// min over frequency of the smallest eigenvalue of He G(z), and of He G(z)^-1 where G(z) can be
/// inverted (so u'y >= level |u|^2, level |y|^2): the levels of Lemmas 1 and 2 for a system between
/// velocity and force whose poles are inside the unit circle. Any sign. -infinity if it is not
/// stable, NaN if malformed.
double input_level(const System& g);
double output_level(const System& g);

}  // namespace hapticd::check
