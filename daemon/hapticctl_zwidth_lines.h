// What theory says of the greatest stiffness of a wall with one damping.
#pragma once
#include <cmath>

#include "config/compile.h"
#include "control/core/result.h"
#include "daemon/axis_loop.h"

namespace hapticd::daemon {

/// N/m of the wall as a config has it; 0: none, infinite: beyond kGreatest_N_m.
struct StiffestWalls {
  double exact = 0;    ///< the device as given, latency_s, alone: eigenvalues of the sampled loop
  double robust = 0;   ///< every sampled case of the box, contact closed
  double paper = 0;    ///< nominally stable in continuous time, and |L| <= 1
  double passive = 0;  ///< what hapticd would prove
  double colgate = 0;  ///< 2 (b - B)/T, b the least damping of the device
};

/// Stiffer walls no config may have.
inline constexpr double kGreatest_N_m = 1e7;

/// The config of a document with its only wall changed. Errors: bad_data.
Result<config::Compiled> with_wall(config::Document document, double stiffness_N_m,
                                   double damping_Ns_m);

Result<StiffestWalls> stiffest_walls(const config::Document& document, double damping_Ns_m);

/// Greatest K for which `holds`, from `low` upwards: doubled until it does not, then bisected to a hundredth. What
/// lies between two tests is not seen. 0: not even `low`; infinite: even kGreatest_N_m.
template <class Holds>
Result<double> stiffest(double low, Holds holds) {
  constexpr double kRatio = 1.01;
  double inside = 0, outside = low;
  for (; outside < kGreatest_N_m; outside *= 2) {
    Result<bool> held = holds(outside);
    if (!held) return tl::unexpected(held.error());
    if (!*held) break;
    inside = outside;
  }
  if (outside >= kGreatest_N_m) return INFINITY;
  while (inside > 0 && outside > kRatio * inside) {
    const double middle = std::sqrt(inside * outside);
    Result<bool> held = holds(middle);
    if (!held) return tl::unexpected(held.error());
    (*held ? inside : outside) = middle;
  }
  return inside;
}

}  // namespace hapticd::daemon
