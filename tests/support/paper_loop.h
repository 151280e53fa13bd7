// The haptic loops of the examples of Bianchini, Orlandesi, Prattichizzo (2010) for any number of
// contacts, and the reference figures (tests/data/paper1/reference.json).
#pragma once
#include <Eigen/Dense>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "control/design/check/linear.h"
#include "control/design/synthesis/loop.h"
#include "tests/support/linear_systems.h"

namespace hapticd::test {

inline constexpr double kPaperPeriod_s = 1e-3;
inline constexpr double kPaperDamping_Ns_m = 1.37;

/// A mass of 3 kg on ground (2600 N/m, 0.5 N s/m) and m contacts, each on the mass by a spring and a
/// damper: 3300 .. 3800 N/m, 0.1 .. 0.3 N s/m, for m = 3 those of the paper; backward Euler. States:
/// contacts a tick ago, the mass' place and velocity.
inline check::System paper_scene(Eigen::Index m, double scale = 1) {
  const double T = kPaperPeriod_s, mass = 3, ground_k = 2600, ground_b = 0.5;
  check::Vector k = check::Vector::LinSpaced(m, 3300, 3800),
                b = check::Vector::LinSpaced(m, 0.1, 0.3);
  if (m == 3) k << 3800, 3500, 3300;
  const double total = mass / T + ground_b + b.sum() + (ground_k + k.sum()) * T;
  check::Matrix from_state = check::Matrix::Zero(2, m + 2), from_input(2, m);  // place, velocity
  for (Eigen::Index i = 0; i < m; ++i) {
    from_state(1, i) = -b[i] / T / total;
    from_input(1, i) = (k[i] + b[i] / T) / total;
  }
  from_state(1, m) = -(ground_k + k.sum()) / total;
  from_state(1, m + 1) = mass / T / total;
  from_state.row(0) = T * from_state.row(1);
  from_state(0, m) += 1;
  from_input.row(0) = T * from_input.row(1);
  check::System e;
  e.A = check::Matrix::Zero(m + 2, m + 2);
  e.A.bottomRows(2) = from_state;
  e.B.resize(m + 2, m);
  e.B << check::Matrix::Identity(m, m), from_input;
  e.C = -k * from_state.row(0) - b * from_state.row(1);
  e.C.leftCols(m) -= check::Matrix((b / T).asDiagonal());
  e.D = -k * from_input.row(0) - b * from_input.row(1);
  e.D += check::Matrix((k + b / T).asDiagonal());
  return check::scaled(e, scale);
}

inline synthesis::HapticLoop paper_loop(Eigen::Index m = 3) {
  return {paper_scene(m), kPaperDamping_Ns_m * check::Matrix::Identity(m, m), kPaperPeriod_s};
}

/// The scene's force comes a sample late: not passive.
inline synthesis::HapticLoop late_loop(double scale) {
  synthesis::HapticLoop loop = paper_loop();
  loop.scene = check::series(check::delay(3), paper_scene(3, scale));
  return loop;
}

inline check::Matrix eye(Eigen::Index m, double value = 1) {
  return value * check::Matrix::Identity(m, m);
}

}  // namespace hapticd::test
