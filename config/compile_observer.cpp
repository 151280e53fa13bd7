// Disturbance observers of the axes of one device, or of the coordinates of its contact.
#include <algorithm>
#include <cmath>

#include "config/axis_units.h"
#include "config/compilation.h"
#include "config/describe.h"
#include "config/number.h"
#include "control/build/filters.h"

namespace hapticd::config {
namespace {

/// One observer of the config, at an axis or at a coordinate of a contact (which is linear).
struct ObserverPlace {
  Compilation& compilation;
  const DevicePlace& device;
  const Observer& observer;
  std::optional<ModelValues> model;
  double friction_slope;  ///< of compensation beside it
  double default_limit;   ///< N or N m
  AxisUnits units;        ///< of its map
};

bool check_mode(const ObserverPlace& place) {
  const ObserverMode mode = place.observer.mode;
  if (!place.model) {
    place.units.refuse("mode",
                       "an observer compares with a model, and this axis has none; give it "
                       "one, or set mode: off");
  }
  if (mode == ObserverMode::sensor && !place.device.device.force_sensor) {
    place.units.refuse("mode",
                       "mode sensor subtracts the measured force of the hand, and this device has "
                       "no force_sensor; add it, or use mode: model");
  }
  if (mode == ObserverMode::classic && !place.observer.i_know_it_cancels_the_hand) {
    place.units.refuse(
        "mode",
        "mode classic rejects the hand's force as it rejects friction: pushed with 5 N, a wall of "
        "1 kN/m ends at 0 mm instead of 5 mm; use mode: model, or sensor with a force_sensor, or "
        "set i_know_it_cancels_the_hand: true");
  }
  return place.model.has_value();
}

/// Mode model feeds (m - m_n) of inertia and (b - b_n) of damping back; with the lightest and least
/// damped device of the model's box what remains has to be positive.
void check_reduction(const ObserverPlace& place, const build::ObserverFigures& figures,
                     const char* mass_key, const char* damping_key) {
  const ModelValues& model = *place.model;
  const double mass = figures.nominal_mass_kg - model.inertia * model.inertia_uncertainty;
  const double damping =
      figures.nominal_damping_Ns_m - model.damping + model.least_damping() - place.friction_slope;
  if (mass <= 0) {
    place.units.refuse(mass_key,
                       "expected more than the model's uncertainty, " +
                           format_number(model.inertia * model.inertia_uncertainty) +
                           ": the lightest device of the model would be pushed on by more than "
                           "its own inertia; found " +
                           format_number(figures.nominal_mass_kg));
  }
  if (damping < 0 || (damping == 0 && figures.nominal_damping_Ns_m < model.damping)) {
    place.units.refuse(damping_key,
                       "the least damping of the model would be cancelled beyond 0, by " +
                           format_number(-damping) + " " + damping_unit(place.units.rotary()) +
                           "; raise it, or compensate less friction");
  }
  if (figures.nominal_mass_kg == model.inertia && figures.nominal_damping_Ns_m == model.damping) {
    place.units.refuse("mode", std::string("nominal figures and model are the same, so mode model "
                                           "does nothing; give it ") +
                                   mass_key + " or " + damping_key + ", or set mode: off");
  }
}

build::ObserverMode build_mode(ObserverMode mode) {
  if (mode == ObserverMode::sensor) return build::ObserverMode::sensor;
  return mode == ObserverMode::classic ? build::ObserverMode::classic : build::ObserverMode::model;
}

/// Figures of an observer that is on and has a model.
build::ObserverFigures figures_of(const ObserverPlace& place) {
  const Observer& observer = place.observer;
  const AxisUnits& units = place.units;
  const Form mass{"nominal_mass_kg", observer.nominal_mass_kg};
  const Form inertia{"nominal_inertia_kgm2", observer.nominal_inertia_kgm2};
  const Form damping{"nominal_damping_Ns_m", observer.nominal_damping_Ns_m};
  const Form turning{"nominal_damping_Nms_rad", observer.nominal_damping_Nms_rad};
  const build::ObserverFigures figures{
      .mode = build_mode(observer.mode),
      .nominal_mass_kg = units.optional(mass, inertia, place.model->inertia),
      .nominal_damping_Ns_m = units.optional(damping, turning, place.model->damping),
      .mass_kg = place.model->inertia,
      .damping_Ns_m = place.model->damping,
      .cutoff_Hz = observer.cutoff_Hz,
      .order = observer.order,
      .delay_ticks = static_cast<std::uint16_t>(observer.extra_delay_ticks),
      .blend_s = observer.blend_s,
      .max_output =
          units.optional(Form{"max_force_N", observer.max_force_N},
                         Form{"max_torque_Nm", observer.max_torque_Nm}, place.default_limit)};
  if (observer.mode == ObserverMode::model)
    check_reduction(place, figures, units.key(mass, inertia), units.key(damping, turning));
  return figures;
}

void add(const ObserverPlace& place, const std::string& path, std::uint16_t source,
         std::vector<control::ObserverPlan>& observers) {
  if (place.observer.mode == ObserverMode::off || !check_mode(place)) return;
  check_cutoff(place.compilation, path, place.observer.cutoff_Hz);
  observers.push_back(build::observer(source, place.device.index, figures_of(place),
                                      place.compilation.spec.period_s));
}

void add_axis_observers(Compilation& compilation, const DevicePlace& device) {
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    const Axis& axis = device.device.axes[i];
    const AxisValues& values = device.axes[i];
    const std::string path = values.path + ".observer";
    const ObserverPlace place{.compilation = compilation,
                              .device = device,
                              .observer = axis.observer,
                              .model = values.model,
                              .friction_slope = values.friction_slope(),
                              .default_limit = values.max_effort,
                              .units = {compilation, axis.kind, path}};
    add(place, path, device.axis(i), compilation.spec.axis_observers);
  }
}

bool check_contact(Compilation& compilation, const DevicePlace& device, std::size_t direction,
                   const std::string& path) {
  const std::vector<std::size_t>& directions = device.frame.directions;
  if (std::find(directions.begin(), directions.end(), direction) == directions.end()) {
    compilation.refuse(path, "device '" + device.device.name +
                                 "' does not move along this world direction; remove it");
    return false;
  }
  if (directions.size() != device.axes.size()) {
    compilation.refuse(path, "a contact of " + std::to_string(directions.size()) +
                                 " coordinates moved by " + std::to_string(device.axes.size()) +
                                 " axes has no force that their efforts stand for; put observers "
                                 "at the axes");
    return false;
  }
  return true;
}

void add_contact_observer(Compilation& compilation, const DevicePlace& device,
                          std::size_t direction, const ContactCoordinate& wanted) {
  const std::string name(word_of(static_cast<Direction>(direction)));
  const std::string path = device.path + ".contact." + name;
  if (!check_contact(compilation, device, direction, path)) return;
  const auto& directions = device.frame.directions;
  const auto own = static_cast<std::size_t>(
      std::find(directions.begin(), directions.end(), direction) - directions.begin());
  const ObserverPlace place{
      .compilation = compilation,
      .device = device,
      .observer = wanted.observer,
      .model = ModelValues{.inertia = wanted.model.mass_kg, .damping = wanted.model.damping_Ns_m},
      .friction_slope = 0,
      .default_limit = device.guard.max_force_N / device.frame.scale,
      .units = {compilation, AxisKind::linear, path + ".observer"}};
  add(place, path + ".observer", device.coordinate(own), compilation.spec.contact_observers);
}

}  // namespace

void compile_observers(Compilation& compilation, const DevicePlace& device) {
  add_axis_observers(compilation, device);
  const Contact& contact = device.device.contact;
  const std::array coordinates{&contact.x, &contact.y, &contact.z};
  for (std::size_t i = 0; i < coordinates.size(); ++i) {
    if (*coordinates[i]) add_contact_observer(compilation, device, i, **coordinates[i]);
  }
  const auto& axes = device.device.axes;
  const bool at_axes = std::any_of(axes.begin(), axes.end(), [](const Axis& axis) {
    return axis.observer.mode != ObserverMode::off;
  });
  const bool at_contact =
      std::any_of(coordinates.begin(), coordinates.end(), [](const auto* coordinate) {
        return *coordinate && (*coordinate)->observer.mode != ObserverMode::off;
      });
  if (at_axes && at_contact) {
    compilation.refuse(device.path + ".contact",
                       "observers stand at the axes or at the contact of a device, not at both: "
                       "each would take the other's output for a disturbance; keep one of them");
  }
}

}  // namespace hapticd::config
