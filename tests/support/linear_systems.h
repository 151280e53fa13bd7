// Linear systems for tests of the analysis: Example 1 of Bianchini et al. (tests/data/paper1) and
// what a spring-damper coupling makes of a scene.
#pragma once
#include <Eigen/Dense>
#include <fstream>
#include <nlohmann/json.hpp>

#include "control/build/network.h"
#include "control/design/check/linear.h"
#include "tests/support/networks.h"

namespace hapticd::test {

using check::Matrix;
using check::System;
using check::Vector;

inline constexpr double kPeriod = 1e-3;
inline constexpr double kDamping = 1.37;

inline const nlohmann::json& paper1_reference() {
  static const auto data =
      nlohmann::json::parse(std::ifstream(HAPTICD_SOURCE_DIR "/tests/data/paper1/reference.json"));
  return data;
}

inline System system_of(const build::LinearScene& scene) {
  return {eigen(scene.A), eigen(scene.B), eigen(scene.C), eigen(scene.D)};
}

inline System paper1_scene() {
  return system_of(
      build::linear_scene({paper1_network()}, kPeriod, build::Integrator::backward_euler, 1));
}

inline Matrix matrix_of(const nlohmann::json& rows) {
  Matrix m(static_cast<Index>(rows.size()), static_cast<Index>(rows.at(0).size()));
  for (Index i = 0; i < m.rows(); ++i)
    for (Index j = 0; j < m.cols(); ++j)
      m(i, j) = rows.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(j));
  return m;
}

inline Matrix identity(Index m) {
  return Matrix::Identity(m, m);
}

/// F = (K + E)^-1 K E in the form E (I + K^-1 E)^-1: a coupling of springs alone.
inline System sprung(const System& scene, const Matrix& K) {
  return check::feedback(scene, check::constant(K.inverse()));
}

}  // namespace hapticd::test
