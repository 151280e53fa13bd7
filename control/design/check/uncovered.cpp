#include "control/design/check/uncovered.h"

#include <cmath>

namespace hapticd::check {
namespace {

/// Joint by joint, where the Jacobian is constant: the dry friction that covers its encoder's steps.
std::string quantisation(const TiedCase& given) {
  const std::string effect = "encoder steps";
  if (given.jointed) return effect;
  const Matrix springs = given.beside(1) - given.beside(0);
  const Matrix j = constant_jacobian(given.plan, given.devices);
  const Demand& needs = given.needs;
  const Matrix stiffness =
      springs +
      j.transpose() * (needs.coupled + 2 / given.plan.period_s * needs.coupled_damper) * j +
      2 / given.plan.period_s * given.beside(0);
  double most = 0;
  Eigen::Index joint = 0;
  for (const std::size_t d : given.devices) {
    const control::DevicePlan& device = given.plan.devices[d];
    for (std::size_t i = 0; i < device.axes; ++i, ++joint) {
      const double step = std::abs(given.plan.axes[device.first_axis + i].unit_per_raw);
      most = std::max(most, 0.5 * step * stiffness(joint, joint));
    }
  }
  return effect +
         worded(" (dry friction of %.3g N or N m in every axis takes up what they leak)", most);
}

}  // namespace

std::vector<ObjectNote> active_objects(const std::vector<DeviceAssumption>& assumed,
                                       const Tied& devices) {
  std::vector<ObjectNote> notes;
  for (const std::size_t d : devices)
    notes.insert(notes.end(), assumed[d].active.begin(), assumed[d].active.end());
  return notes;
}

std::vector<ObjectNote> uncertified_objects(const TiedCase& given, const PassiveAnswer& answer) {
  std::vector<ObjectNote> notes = active_objects(given.assumed, given.devices);
  const bool needs_passive =
      given.heavy || given.negative || !given.plain || (given.latency > 0 && given.damped);
  if (answer.proved || !needs_passive || given.scene.passive()) return notes;
  for (const std::size_t d : given.devices)
    for (const std::string& label : given.assumed[d].nonconvex)
      notes.push_back({label, given.heavy ? "is not convex and is felt together with the masses of "
                                            "a network"
                                          : "is not convex; this coupling needs a passive scene"});
  return notes;
}

std::vector<std::string> uncovered(const TiedCase& given, const PassiveAnswer& answer) {
  std::vector<std::string> effects = {
      quantisation(given),
      "dynamics of the actuators and of the structure between them and the hand",
      "limits while they bite (force, slew, speed, heat, ramp): what they do is booked"};
  if (given.needs.has_observer)
    effects.emplace_back("an observer whose output is at its limit or still fading in");
  if (answer.theorem == Theorem::passive_scene && given.scene.any)
    effects.emplace_back("solves that end before they are exact: they are in the record");
  if (answer.theorem == Theorem::this_scene)
    effects.emplace_back("any other scene, and latency that changes from tick to tick");
  return effects;
}

}  // namespace hapticd::check
