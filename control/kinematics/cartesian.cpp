#include "control/kinematics/cartesian.h"

namespace hapticd::control {

void forward(const Plan& plan, State& state) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes) {
    state.x[pair.coordinate] = state.q[pair.axis];
    state.v[pair.coordinate] = state.qd[pair.axis];
  }
}

void transpose(const Plan& plan, State& state) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes)
    state.effort[pair.axis] = state.force[pair.coordinate];
}

}  // namespace hapticd::control
