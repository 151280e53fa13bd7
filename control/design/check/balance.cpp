#include "control/design/check/balance.h"

#include <cmath>

namespace hapticd::check {

Vector balance(const Matrix& a) {
  const Eigen::Index n = a.rows();
  Vector d = Vector::Ones(n);
  for (int sweep = 0; sweep < 40; ++sweep) {
    bool changed = false;
    for (Eigen::Index i = 0; i < n; ++i) {
      double row = 0, column = 0;
      for (Eigen::Index j = 0; j < n; ++j) {
        if (j == i) continue;
        row += std::abs(a(i, j)) * d(j) / d(i);
        column += std::abs(a(j, i)) * d(i) / d(j);
      }
      if (row == 0 || column == 0) continue;
      const double factor = std::exp2(std::round(0.5 * std::log2(row / column)));
      changed = changed || factor != 1;
      d(i) *= factor;
    }
    if (!changed) break;
  }
  return d;
}

}  // namespace hapticd::check
