#include "control/kinematics/kinematics.h"

#include "control/plan.h"
#include "control/state.h"

namespace hapticd::control {

void forward(const Plan& plan, State& state, Findings&) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes) {
    state.x[pair.coordinate] = pair.scale * state.q[pair.axis] + pair.origin;
    state.v[pair.coordinate] = pair.scale * state.qd[pair.axis];
  }
}

void transpose(const Plan& plan, const State&, std::span<const double> force,
               std::span<double> effort) noexcept {
  for (const CartesianAxis& pair : plan.cartesian_axes)
    effort[pair.axis] = pair.scale * force[pair.coordinate];
}

bool contact_force(const Plan& plan, const State&, std::size_t device, const double* effort,
                   double* force) noexcept {
  const DevicePlan& at = plan.devices[device];
  for (const CartesianAxis& pair : plan.cartesian_axes) {
    if (pair.axis < at.first_axis || pair.axis >= at.first_axis + at.axes) continue;
    force[pair.coordinate - at.first_coordinate] = effort[pair.axis - at.first_axis] / pair.scale;
  }
  return true;
}

}  // namespace hapticd::control
