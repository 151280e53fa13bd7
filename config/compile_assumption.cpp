// What the stability check may assume of each device, and why its closed form does not hold where
// it does not. That is proved for held forces of planes and springs on devices whose Jacobian is
// constant, with velocities by the backward difference (control/design/check/stability.h).
#include <algorithm>
#include <string>

#include "config/compilation.h"
#include "config/describe.h"

namespace hapticd::config {
namespace {

/// Does a plane with damping act on the contact of this device?
bool feels_damping(const build::ProgramSpec& spec, const DevicePlace& place) {
  return std::any_of(spec.planes.begin(), spec.planes.end(), [&](const control::PlaneContact& p) {
    return p.first_coordinate == place.first_coordinate && p.damping > 0;
  });
}

/// A device all of whose axes have a model: the least damping of each.
std::vector<double> min_damping(const DevicePlace& place) {
  std::vector<double> damping;
  for (const AxisValues& axis : place.axes) {
    if (!axis.model) return {};
    damping.push_back(axis.model->least_damping());
  }
  return damping;
}

bool has_observer(const Device& device) {
  const auto is_on = [](const auto& at) { return at.observer.mode != ObserverMode::off; };
  const Contact& contact = device.contact;
  return std::any_of(device.axes.begin(), device.axes.end(), is_on) ||
         (contact.x && is_on(*contact.x)) || (contact.y && is_on(*contact.y)) ||
         (contact.z && is_on(*contact.z));
}

/// Axes whose velocity is estimated otherwise and matters to a force.
std::string estimator_obstacle(const build::ProgramSpec& spec, const DevicePlace& place) {
  const bool damped = feels_damping(spec, place);
  for (std::size_t i = 0; i < place.axes.size(); ++i) {
    const Axis& axis = place.device.axes[i];
    const bool matters =
        damped || place.axes[i].friction.viscous > 0 || place.axes[i].friction.coulomb > 0;
    if (axis.velocity.estimator == Estimator::backward_difference || !matters) continue;
    return "axis " + axis.name + ": damping by the velocity of " +
           std::string(word_of(axis.velocity.estimator)) +
           " is beyond the closed form, which holds for the backward difference";
  }
  return {};
}

std::vector<std::string> obstacles(const build::ProgramSpec& spec, const DevicePlace& place) {
  std::vector<std::string> found;
  if (!std::holds_alternative<Cartesian>(place.device.kinematics)) {
    const auto kind = [](const auto& of) {
      return std::string(kKindOf<std::decay_t<decltype(of)>>);
    };
    found.push_back(std::visit(kind, place.device.kinematics) +
                    ": torques are held, not forces, so it needs the condition in joint space "
                    "over the whole workspace, which is not checked yet");
  }
  if (has_observer(place.device)) {
    found.emplace_back("a disturbance observer is on; the closed form knows the device without it");
  }
  if (std::string text = estimator_obstacle(spec, place); !text.empty())
    found.push_back(std::move(text));
  return found;
}

}  // namespace

void compile_assumptions(Compilation& compilation, const std::vector<DevicePlace>& places) {
  for (const DevicePlace& place : places) {
    compilation.assumed.push_back({.name = place.device.name,
                                   .latency_s = place.device.latency_s,
                                   .min_damping = min_damping(place),
                                   .obstacles = obstacles(compilation.spec, place)});
  }
}

}  // namespace hapticd::config
