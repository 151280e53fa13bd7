// Levels of passivity of (A, B, C, D) by linear matrix inequalities: Lemmas 1 and 2 of Bianchini,
// Orlandesi and Prattichizzo (2010), "Passivity-based analysis and design of multi-contact haptic
// systems via LMIs", discrete time, levels as symmetric matrices of any sign.
//
// With the storage x'Px, S(k+1) - S(k) <= y'u - y' Delta y - u' Phi u along all motions reads
//
//   L(P) = [P - A'PA - C' Delta C,  C'/2 - A'PB - C' Delta D;
//           *,                      (D + D')/2 - B'PB - D' Delta D - Phi]  >= 0,   P > 0         (2)
//
// (Lemma 1). For Delta > 0, Schur's complement of what is quadratic in (A, B, C, D), Q = P^-1:
//
//   [Y, R'; R, S] > 0,  R = [C/2; A; C],  S = [(D + D')/2 - Phi, B', D'; B, Q, 0; D, 0, Delta^-1],
//   Y = Q^-1                                                                                    (15)
//
// (Lemma 2, where Phi is printed with the other sign: (2) decides).
//
// Poles and zeros at z = 1. (2) has no strictly feasible point where A has the eigenvalue 1 (the
// integrators that E-hat = E Tz/(z-1) brings) or where G(1) is singular (V-hat = (z-1)/(Tz) (V-K)
// vanishes there). No pole is moved; the face of the cone on which P must lie is taken instead:
//   G = R/(z-1) + G_s, and R/(z-1) = (R/2) (z+1)/(z-1) - R/2. On the unit circle (z+1)/(z-1) is
//   imaginary, so G is positive real iff R = R' >= 0 and G_s - R/2 is; and G_s has its poles inside.
//   In (2) that is P = blkdiag(P1, P2), B1'P1 = C1/2. G_s - R/2 has a strictly feasible point.
//   The inequality above is the same with u and y exchanged: the output level of G is the input
//   level of G^-1, whose pole at 1 is G's zero there. D is regular wherever there is a level and
//   every input acts: for D v = 0, v'(2)v = -v'B'PBv >= 0 asks for B v = 0.
#pragma once
#include <string>

#include "control/design/synthesis/lmi.h"

namespace hapticd::synthesis {

using check::System;

enum class LevelShape : std::uint8_t {
  isotropic,  ///< level I
  diagonal,
  full,  ///< symmetric
};

struct Level {
  bool found = false;
  Matrix level;     ///< m x m, of the largest trace; its sign may be any
  std::string why;  ///< where there is none, or the solver did not find it
};

/// Largest Phi for which G is Phi-ISP, G - Phi passive; u and y of the same number.
Level lmi_input_level(const System& g, LevelShape shape = LevelShape::full);
/// Largest Delta for which G is Delta-OSP, G^-1 - Delta passive. D regular.
Level lmi_output_level(const System& g, LevelShape shape = LevelShape::full);

/// L(P) of (2).
Matrix lemma1(const System& g, const Matrix& p, const Matrix& delta, const Matrix& phi);
/// The matrix of (15) with Y = Q^-1.
Matrix lemma2(const System& g, const Matrix& q, const Matrix& delta, const Matrix& phi);

/// The upper right triangle of blocks of L(P) with Delta = 0, as symmetric_blocks takes it: the
/// inequality G - Phi passive, linear in P and Phi.
Affine passive_matrix(const System& g, const Affine& p, const Affine& phi);

}  // namespace hapticd::synthesis
