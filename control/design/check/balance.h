// Scaling of a matrix before its eigenvalues or a Riccati equation are asked for.
#pragma once
#include "control/design/check/linear.h"

namespace hapticd::check {

/// Powers of two d > 0 for which the rows and columns of diag(d)^-1 A diag(d) are of like size
/// (Osborne 1960): no rounding, the same eigenvalues. A square and finite.
Vector balance(const Matrix& a);

}  // namespace hapticd::check
