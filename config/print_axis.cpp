#include "config/print_axis.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "config/axis_values.h"
#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// The entry of `list` for an axis, or none.
template <class Entry>
const Entry* entry_of(std::span<const Entry> list, std::size_t axis) {
  const auto found = std::find_if(list.begin(), list.end(),
                                  [&](const Entry& entry) { return entry.axis == axis; });
  return found == list.end() ? nullptr : &*found;
}

std::string sensor_text(const Axis& axis, const control::AxisPlan& plan, bool rotary) {
  const double counts = (rotary ? 2 * std::numbers::pi : 1.0) / std::abs(plan.unit_per_raw);
  return with_unit(counts, rotary ? "counts/revolution" : "counts/m") +
         (axis.encoder.reversed ? ", reversed" : "") +
         (plan.modulus_raw > 0
              ? ", wraps every " +
                    with_unit(plan.modulus_raw * std::abs(plan.unit_per_raw), position_unit(rotary))
              : "") +
         ", actuator " + with_unit(plan.max_effort, effort_unit(rotary)) + "\n";
}

std::string model_text(const Axis& axis, bool rotary) {
  if (!axis.model) return "    no model: nothing can be proved\n";
  const AxisModel& model = *axis.model;
  const double inertia = rotary ? model.inertia_kgm2.value_or(0) : model.mass_kg.value_or(0);
  const double damping =
      rotary ? model.damping_Nms_rad.value_or(0) : model.damping_Ns_m.value_or(0);
  const double coulomb = rotary ? model.coulomb_Nm.value_or(0) : model.coulomb_N.value_or(0);
  return "    model: " + with_unit(inertia, rotary ? "kg m^2" : "kg") + " +- " +
         with_unit(100 * model.mass_uncertainty, "%") + ", " +
         with_unit(damping, damping_unit(rotary)) + " +- " +
         with_unit(100 * model.damping_uncertainty, "%") +
         (coulomb > 0 ? ", dry friction " + with_unit(coulomb, effort_unit(rotary)) : "") + "\n";
}

std::string observer_text(const Axis& axis) {
  if (axis.observer.mode == ObserverMode::off) return {};
  return "    observer: " + std::string(word_of(axis.observer.mode)) + ", order " +
         std::to_string(axis.observer.order) + ", " + with_unit(axis.observer.cutoff_Hz, "Hz") +
         "\n";
}

std::string friction_text(const control::FrictionAxis* friction, bool rotary) {
  if (friction == nullptr) return {};
  return "    friction compensated: " + with_unit(friction->viscous, damping_unit(rotary)) + ", " +
         with_unit(friction->coulomb, effort_unit(rotary)) + " in full from " +
         with_unit(friction->smooth, rotary ? "rad/s" : "m/s") + "\n";
}

std::string gravity_text(const control::GravityAxis* weight, bool rotary) {
  if (weight == nullptr) return {};
  return "    weight held: " + with_unit(weight->constant, effort_unit(rotary)) +
         (rotary ? " + " + with_unit(weight->swing, "N m") + " cos(q + " +
                       with_unit(weight->phase, "rad") + ")"
                 : "") +
         "\n";
}

std::string homing_text(const Axis& axis, const control::HomingPlan* homing, bool rotary) {
  if (homing == nullptr) return {};
  const std::string by = "    homed by " + std::string(word_of(axis.homing.by));
  if (homing->by == control::HomingBy::device) return by + "\n";
  return by + " at " + with_unit(homing->position, position_unit(rotary)) +
         (homing->effort == 0 ? ", moved by hand"
                              : ", search with " + with_unit(homing->effort, effort_unit(rotary))) +
         "\n";
}

std::string travel_text(const control::TravelPlan* travel, bool rotary) {
  if (travel == nullptr) return {};
  return "    travel: " + format_number(travel->min) + " to " +
         with_unit(travel->max, position_unit(rotary)) + ", springs of " +
         with_unit(travel->stiffness, rotary ? "N m/rad" : "N/m") + ", a fault " +
         with_unit(travel->margin, position_unit(rotary)) + " beyond\n";
}

}  // namespace

std::string with_unit(double value, const char* unit) {
  return format_number(value) + " " + unit;
}

std::string axis_text(const control::Plan& plan, std::size_t index, const Axis& axis,
                      const std::string& along) {
  const bool rotary = axis.kind == AxisKind::rotary;
  std::string text = "  axis " + axis.name + along + ": " +
                     sensor_text(axis, plan.axes[index], rotary) + model_text(axis, rotary);
  if (axis.velocity.estimator != Estimator::backward_difference)
    text += "    velocity: " + std::string(word_of(axis.velocity.estimator)) + "\n";
  text += observer_text(axis);
  text += friction_text(entry_of(plan.frictions, index), rotary);
  text += gravity_text(entry_of(plan.gravity_axes, index), rotary);
  text += homing_text(axis, entry_of(plan.homings, index), rotary);
  text += travel_text(entry_of(plan.travels, index), rotary);
  if (const control::ThermalPlan* heat = entry_of(plan.thermals, index))
    text += "    continuous: " + with_unit(heat->continuous, effort_unit(rotary)) + "\n";
  return text;
}

}  // namespace hapticd::config
