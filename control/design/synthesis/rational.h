// Transfer functions in continuous time, as quotients of polynomials and as state space.
//
// A check::System is read as x' = A x + B u, y = C x + D u here. z = (1 + s/a)/(1 - s/a), a > 0, maps
// the left half-plane onto the unit disc, and with
//
//   Ad = (a I - A)^-1 (a I + A),  Bd = sqrt(2a) (a I - A)^-1 B,
//   Cd = sqrt(2a) C (a I - A)^-1,  Dd = D + C (a I - A)^-1 B                                        (1)
//
// the values on the imaginary axis are those on the circle, so that the H-infinity norm stays, and
// A X + X A' + B B' = 0 has the solution of Ad X Ad' - X + Bd Bd' = 0: both are found by what finds
// them in discrete time. a is near the poles for the sake of rounding.
#pragma once
#include <string>

#include "control/design/check/linear.h"

namespace hapticd::synthesis {

using check::Complex;
using check::Matrix;
using check::System;
using check::Vector;

/// Coefficients in ascending powers of s.
Vector times(const Vector& a, const Vector& b);
Vector plus(const Vector& a, const Vector& b);
Complex at(const Vector& polynomial, Complex s);

struct Rational {
  Vector num = Vector::Zero(1), den = Vector::Ones(1);  ///< ascending powers of s
};
Complex at(const Rational& g, Complex s);
/// Without leading zeros, and without common zeros at s = 0.
Rational reduced(const Rational& g);
/// What cannot be realised: entries that are not finite, no denominator, more zeros than poles.
std::string malformed(const Rational& g);
/// n states, one input, one output: D + C (s I - A)^-1 B as a quotient (Faddeev and Leverrier).
/// For the few states that a weight has.
Rational quotient(const System& g);

/// Companion form, in units of time in which the poles' geometric mean is one. `g` is well formed
/// and reduced.
System realised(const Rational& g);
/// Largest real part of an eigenvalue of A; -infinity without states.
double abscissa(const System& g);
/// (1). A has no eigenvalue in the right half-plane.
System on_disc(const System& g);
/// C X C' with A X + X A' + B B' = 0: products of the outputs' impulse responses, integrated. A
/// Hurwitz, D = 0.
Matrix output_energy(const System& g);

}  // namespace hapticd::synthesis
