#include "control/scene/render.h"

#include <algorithm>

#include "control/scene/solve.h"

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
  for (const ContactPlan& contact : plan.contacts) {
    if (contact.first_coordinate == device.first_coordinate)
      sum += stored_energy(plan, state, contact);
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

namespace {

void solve_all(const Plan& plan, State& state, const TickInput& input,
               Findings& findings) noexcept {
  state.scene_last_s = state.scene_time_s;
  state.scene_time_s = static_cast<double>(input.tick) * plan.period_s;
  for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
    if (plan.contacts[i].group == ContactPlan::kNoGroup) touch_directly(plan, state, i);
  }
  for (std::size_t i = 0; i < plan.groups.size(); ++i) solve_group(plan, state, i);
  for (const ContactState& contact : state.contacts) {
    if (contact.slack != Vec3{}) findings.limits.set(Limit::force);
  }
}

}  // namespace

void render(const Plan& plan, State& state, const TickInput& input, Findings& findings) noexcept {
  std::fill(state.scene_force.begin(), state.scene_force.end(), 0.0);
  add_all(plan.planes, state);
  if (!plan.contacts.empty()) solve_all(plan, state, input, findings);
}

}  // namespace hapticd::control
