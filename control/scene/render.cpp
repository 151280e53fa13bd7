#include "control/scene/render.h"

#include <algorithm>

namespace hapticd::control {
namespace {

template <class Object>
void add_all(std::span<const Object> objects, State& state) noexcept {
  for (const Object& object : objects) {
    add_force(object, &state.x[object.first_coordinate], &state.v[object.first_coordinate],
              &state.scene_force[object.first_coordinate]);
  }
}

}  // namespace

double stored_energy(const PlaneContact& plane, const double* x) noexcept {
  double depth = plane.offset;
  for (std::size_t i = 0; i < plane.coordinates; ++i) depth -= plane.normal[i] * x[i];
  return depth > 0 ? 0.5 * plane.stiffness * depth * depth : 0;
}

double stored_energy(const Plan& plan, const State& state, const DevicePlan& device) noexcept {
  double sum = 0;
  for (const PlaneContact& plane : plan.planes) {
    if (plane.first_coordinate == device.first_coordinate)
      sum += stored_energy(plane, &state.x[plane.first_coordinate]);
  }
  return sum;
}

void add_force(const PlaneContact& plane, const double* x, const double* v,
               double* force) noexcept {
  double depth = plane.offset;
  double sinking = 0;  // m/s into the wall
  for (std::size_t i = 0; i < plane.coordinates; ++i) {
    depth -= plane.normal[i] * x[i];
    sinking -= plane.normal[i] * v[i];
  }
  if (!(depth > 0)) return;
  const double push = plane.stiffness * depth + plane.damping * sinking;
  if (push < 0) return;  // not max(0, push): that would turn a NaN into a silent zero
  for (std::size_t i = 0; i < plane.coordinates; ++i) force[i] += plane.normal[i] * push;
}

void render(const Plan& plan, State& state) noexcept {
  std::fill(state.scene_force.begin(), state.scene_force.end(), 0.0);
  add_all(plan.planes, state);
}

}  // namespace hapticd::control
