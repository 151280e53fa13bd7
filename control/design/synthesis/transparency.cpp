#include "control/design/synthesis/transparency.h"

namespace hapticd::synthesis {

using check::series;

Weights unweighted(Eigen::Index m) {
  const System identity = check::constant(check::Matrix::Identity(m, m));
  return {identity, identity};
}

System low_pass(double corner_rad_s, double period_s, Eigen::Index m) {
  // w (1 + c) - w_old = c u, c = corner T.
  const double c = corner_rad_s * period_s, keep = 1 / (1 + c);
  const check::Matrix identity = check::Matrix::Identity(m, m);
  return {keep * identity, c * keep * identity, keep * identity, c * keep * identity};
}

check::Norm loop_shaping_norm(const System& scene, const System& coupling, const Weights& weights) {
  return check::h_infinity(series(weights.left, series(scene, series(coupling, weights.right))));
}

check::Norm closed_loop_norm(const System& scene, const System& coupling, const Weights& weights) {
  const System error = check::sum(check::feedback(scene, coupling), check::scaled(scene, -1));
  return check::h_infinity(series(weights.left, series(error, weights.right)));
}

}  // namespace hapticd::synthesis
