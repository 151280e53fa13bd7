// Quantile of Student's distribution by the expansion in 1/dof of Peiser (Abramowitz, Stegun 26.7.5).
#pragma once

namespace hapticd::identify {

/// t such that 99 % lie within +- t: 0.5 % too small at 4 degrees of freedom, less above.
inline double student_99(double dof) noexcept {
  constexpr double z = 2.575829303549;
  constexpr double z2 = z * z;
  const double n = dof;
  const double g1 = (z2 + 1) * z / 4;
  const double g2 = ((5 * z2 + 16) * z2 + 3) * z / 96;
  const double g3 = (((3 * z2 + 19) * z2 + 17) * z2 - 15) * z / 384;
  const double g4 = ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) * z / 92160;
  return z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n;
}

}  // namespace hapticd::identify
