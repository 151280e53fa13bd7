// Linear systems in discrete time, as the checks and the design handle them:
//
//   xi' = A xi + B u,   y = C xi + D u,   G(z) = D + C (z I - A)^-1 B
//
// n states, m inputs, p outputs; A, B, C may be empty (n = 0). One step is one period.
#pragma once
#include <Eigen/Core>
#include <complex>

#include "control/core/algebra.h"

namespace hapticd::check {

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;
using Complex = std::complex<double>;
using ComplexMatrix = Eigen::MatrixXcd;

struct System {
  Matrix A;  ///< n x n
  Matrix B;  ///< n x m
  Matrix C;  ///< p x n
  Matrix D;  ///< p x m
  Eigen::Index states() const noexcept { return A.rows(); }
  Eigen::Index inputs() const noexcept { return D.cols(); }
  Eigen::Index outputs() const noexcept { return D.rows(); }
};

/// y = gain u.
System constant(const Matrix& gain);
/// G(z); z must be no eigenvalue of A.
ComplexMatrix at(const System& g, Complex z);
/// G(1); 1 must be no eigenvalue of A.
Matrix at_rest(const System& g);

/// `second` after `first`: second(z) first(z).
System series(const System& second, const System& first);
System sum(const System& a, const System& b);
System scaled(const System& g, double factor);
/// Side by side: block diagonal.
System beside(const System& a, const System& b);
/// (I + loop)^-1 of the signal that goes round: y = G (u - H y). D of both together must be
/// regular: I + D_G D_H.
System feedback(const System& g, const System& h);
/// G^-1; D square and regular.
System inverse(const System& g);
/// u one step later: z^-1 I of size m.
System delay(Eigen::Index m);

using algebra::eigenvalues;
/// Largest size of an eigenvalue of A; 0 without states; NaN as above.
double spectral_radius(const Matrix& a);
/// 0.5 (m + m').
Matrix symmetric_part(const Matrix& m);
/// Smallest and largest eigenvalue of a symmetric matrix (lower triangle is read).
double smallest_eigenvalue(const Matrix& m);
double largest_eigenvalue(const Matrix& m);
/// Smallest eigenvalue of (m + m^H) / 2.
double smallest_hermitian(const ComplexMatrix& m);
double largest_singular(const ComplexMatrix& m);

}  // namespace hapticd::check
