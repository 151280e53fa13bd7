#include "config/axis_values.h"

#include <cmath>
#include <numbers>

#include "config/axis_units.h"
#include "config/compilation.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

double counts_per_unit(const AxisUnits& units, const Encoder& encoder) {
  const double counts = units.required(Form{"counts_per_m", encoder.counts_per_m},
                                       Form{"counts_per_rev", encoder.counts_per_rev});
  return units.rotary() ? counts / (2 * std::numbers::pi) : counts;
}

ModelValues model_values(const AxisUnits& units, const AxisModel& model) {
  return {.inertia = units.required(Form{"mass_kg", model.mass_kg},
                                    Form{"inertia_kgm2", model.inertia_kgm2}),
          .damping = units.required(Form{"damping_Ns_m", model.damping_Ns_m},
                                    Form{"damping_Nms_rad", model.damping_Nms_rad}),
          .coulomb = units.optional(Form{"coulomb_N", model.coulomb_N},
                                    Form{"coulomb_Nm", model.coulomb_Nm}, 0),
          .inertia_uncertainty = model.mass_uncertainty,
          .damping_uncertainty = model.damping_uncertainty};
}

std::optional<double> continuous_effort(const AxisUnits& units, const Actuator& actuator,
                                        double max_effort) {
  const Form linear{"continuous_force_N", actuator.continuous_force_N};
  const Form rotary{"continuous_torque_Nm", actuator.continuous_torque_Nm};
  const std::optional<double> continuous = units.given(linear, rotary);
  if (continuous && *continuous > max_effort) {
    units.refuse(units.key(linear, rotary),
                 "expected at most what the actuator can deliver, " + format_number(max_effort) +
                     " " + effort_unit(units.rotary()) + ", found " + format_number(*continuous));
  }
  return continuous;
}

/// Speed from which dry friction is compensated in full. By default coulomb / smooth is half of the
/// damping that is left.
double smooth_speed(const AxisUnits& units, const Compensation& compensation, double coulomb,
                    double left) {
  const double otherwise = coulomb > 0 && left > 0 ? 2 * coulomb / left : 1;
  return units.optional(Form{"smooth_m_s", compensation.smooth_m_s},
                        Form{"smooth_rad_s", compensation.smooth_rad_s}, otherwise);
}

/// The effort u = L v of slope L at rest acts with v the last displacement e over T: it gives out
/// u d <= (L/2T) (e^2 + d^2) over the next displacement d, so it costs exactly L of the damping.
/// Beyond the least damping rest is no longer stable, and a limit cycle may start.
void check_slope(const AxisUnits& units, const AxisValues& values) {
  if (values.surely_dissipated() > 0 || std::isnan(values.surely_dissipated())) return;
  const bool viscous_alone = values.friction.viscous >= values.model->least_damping();
  units.refuse(viscous_alone ? "viscous_share" : "coulomb_share",
               "friction compensation has a slope of " + format_number(values.friction_slope()) +
                   " " + damping_unit(values.rotary) +
                   " at rest, expected less than the model's least damping, " +
                   format_number(values.model->least_damping()) +
                   ": beyond it the axis could cycle for ever; lower the shares, or raise " +
                   (values.rotary ? "smooth_rad_s" : "smooth_m_s"));
}

control::FrictionAxis friction(const AxisUnits& units, const Compensation& compensation,
                               const std::optional<ModelValues>& model) {
  const bool named = compensation.viscous_share > 0 || compensation.coulomb_share > 0;
  if (named && !model) {
    units.refuse(
        compensation.viscous_share > 0 ? "viscous_share" : "coulomb_share",
        "a share of what? The axis has no model; give it one with its damping and friction");
  }
  if (compensation.coulomb_share > 0 && model && model->coulomb == 0) {
    units.refuse("coulomb_share",
                 std::string("the model has no dry friction to take over; give it ") +
                     (units.rotary() ? "coulomb_Nm" : "coulomb_N"));
  }
  const ModelValues known = model.value_or(ModelValues{});
  const double viscous = compensation.viscous_share * known.damping;
  const double coulomb = compensation.coulomb_share * known.coulomb;
  const double left = known.least_damping() - viscous;
  return {.viscous = viscous,
          .coulomb = coulomb,
          .smooth = smooth_speed(units, compensation, coulomb, left)};
}

}  // namespace

AxisValues axis_values(Compilation& compilation, const Axis& axis, const std::string& path,
                       const EffectiveGuard& guard) {
  const auto units = [&](const char* map) { return AxisUnits(compilation, axis.kind, path + map); };
  const Encoder& encoder = axis.encoder;
  AxisValues values;
  values.path = path;
  values.rotary = axis.kind == AxisKind::rotary;
  values.counts_per_unit = counts_per_unit(units(".encoder"), encoder);
  values.offset =
      units(".encoder")
          .optional(Form{"offset_m", encoder.offset_m}, Form{"offset_rad", encoder.offset_rad}, 0);
  values.max_effort = units(".actuator")
                          .required(Form{"max_force_N", axis.actuator.max_force_N},
                                    Form{"max_torque_Nm", axis.actuator.max_torque_Nm});
  values.max_velocity = values.rotary ? guard.max_velocity_rad_s : guard.max_velocity_m_s;
  values.continuous = continuous_effort(units(".actuator"), axis.actuator, values.max_effort);
  if (axis.model) values.model = model_values(units(".model"), *axis.model);
  values.friction = friction(units(".compensation"), axis.compensation, values.model);
  if (values.model && values.friction_slope() > 0) check_slope(units(".compensation"), values);
  return values;
}

}  // namespace hapticd::config
