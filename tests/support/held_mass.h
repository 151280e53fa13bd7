// A mass with a damper to ground under a force that is held between ticks, in closed form:
//   v -> w + (v - w) e^{-bT/m},  x -> x + w T + (v - w) (m/b) (1 - e^{-bT/m}),  w = f/b
#pragma once
#include <cmath>

namespace hapticd::test {

struct HeldMass {
  double mass_kg = 0;
  double damping_Ns_m = 0;
  double x = 0;  ///< m
  double v = 0;  ///< m/s

  void advance(double force_N, double period_s) {
    if (damping_Ns_m == 0) {
      const double gained = force_N / mass_kg * period_s;
      x += (v + 0.5 * gained) * period_s;
      v += gained;
      return;
    }
    const double final_m_s = force_N / damping_Ns_m;
    const double decay = std::expm1(-damping_Ns_m * period_s / mass_kg);
    x += final_m_s * period_s - (v - final_m_s) * (mass_kg / damping_Ns_m) * decay;
    v += (v - final_m_s) * decay;
  }
};

}  // namespace hapticd::test
