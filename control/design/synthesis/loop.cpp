#include "control/design/synthesis/loop.h"

#include <Eigen/Dense>

namespace hapticd::synthesis {

namespace {

Matrix eye(Eigen::Index m) {
  return Matrix::Identity(m, m);
}

}  // namespace

Matrix device_level(const std::vector<Matrix>& devices) {
  System all = check::constant(Matrix(0, 0));
  for (const Matrix& level : devices) all = check::beside(all, check::constant(level));
  return all.D;
}

System transformed_scene(const System& scene, double period_s) {
  const Matrix one = eye(scene.inputs());
  return check::series(scene, System{one, one, period_s * one, period_s * one});
}

System transformed_coupling(const System& coupling, const HapticLoop& loop) {
  const Matrix one = eye(coupling.inputs());
  System shifted = coupling;
  shifted.D -= half_compliance(loop);
  const System difference{0 * one, one, -one / loop.period_s, one / loop.period_s};
  return check::series(difference, shifted);
}

Matrix half_compliance(const HapticLoop& loop) {
  return 0.5 * loop.period_s * loop.device_level.inverse();
}

System backed_off_inverse(const System& coupling, const HapticLoop& loop) {
  System shifted = coupling;
  shifted.D -= half_compliance(loop);
  return check::inverse(shifted);
}

System without_integrator(const System& g, double period_s) {
  if (g.states() == 0) return check::constant(0.5 * period_s * g.D);
  const auto lu = (eye(g.states()) - g.A).partialPivLu();
  const Matrix rest = lu.solve(g.B);
  return {g.A, -period_s * g.A * rest, g.C,
          period_s * g.D - 0.5 * period_s * check::symmetric_part(g.D + g.C * rest)};
}

}  // namespace hapticd::synthesis
