// Springs and dampers in front of a scene that is not passive, but nearly: E + Phi_E is, with a level
// Phi_E N s/m over the m coordinates of the coupling. Bodies and fields that are rho-weakly convex
// (objects.h) give up to (rho/2) |dy|^2 more than they store, and so have the level (T/2) rho; levels
// of a network and of bodies on its contacts add up. The coupling's own level is what it takes of the
// proxies' motion. Without latency, for B >= 0 and N = K^-1 - (T/2) Delta^-1 > 0, it is exactly
//
//   Delta_V = (T/2) N^-1 + N^-1 K^-1 B K^-1 N^-1
//
// and the loop is passive if (10) of the paper holds, that is
//
//   Phi_E < (Delta^-1 + Delta_V^-1)^-1                                                          (1)
//
// B = 0: Delta^-1 + (2/T) N = (2/T) K^-1, so (1) says (2/T) Phi_E < K, beside K < (2/T) Delta: springs
// must be stiffer than the scene is weak, and softer than the device's damping allows.
#pragma once
#include <functional>

#include "control/design/check/linear.h"

namespace hapticd::check {

/// Delta_V; empty where K, N or Delta - K T/2 - B are not > 0, or B is not >= 0.
Matrix spring_damper_level(const Matrix& K, const Matrix& B, const Matrix& damping,
                           double period_s);

/// Smallest eigenvalue of the difference of both sides of (1), N s/m; `level` > 0.
double level_margin(const Matrix& phi, const Matrix& level, const Matrix& damping);

/// Least share s of the damping for which (1) holds, to 1e-9; infinity: none. `damping(s)`: Delta that
/// this share leaves, growing with s; empty: none.
double share_with_level(const Matrix& K, const Matrix& B, const Matrix& phi,
                        const std::function<Matrix(double)>& damping, double period_s);

}  // namespace hapticd::check
