// The axes of one device to the plan's arrays: encoder and actuator, velocity estimate, homing,
// travel, temperature.
#include <algorithm>
#include <cmath>

#include "config/axis_units.h"
#include "config/compilation.h"
#include "config/describe.h"
#include "config/number.h"
#include "control/build/filters.h"

namespace hapticd::config {
namespace {

constexpr double kStuckEffortShare =
    0.2;  // of the force limit: under less an axis may well stand still
constexpr double kSearchEffortShare = 0.25;  // of the actuator: a search pushes against a stop
constexpr double kSearchRise_s = 0.5;        // its effort grows over this time
constexpr double kSearchVelocity_m_s = 0.05;
constexpr double kSearchVelocity_rad_s = 0.5;

/// Smallest number of bits whose half range is more than `counts`.
int bits_for(double counts) {
  int bits = 1;
  while (std::ldexp(1.0, bits - 1) <= counts) ++bits;
  return bits;
}

std::uint32_t ticks_of(double time_s, double period_s) {
  return static_cast<std::uint32_t>(std::max(1.0, std::round(time_s / period_s)));
}

/// An axis of the config with all that its parts are made from.
struct AxisPlace {
  Compilation& compilation;
  const DevicePlace& device;
  const Axis& axis;
  const AxisValues& values;
  std::uint16_t index;  ///< over all devices

  build::ProgramSpec& spec() const { return compilation.spec; }
  double period_s() const { return compilation.spec.period_s; }
  AxisUnits units(const char* map) const { return {compilation, axis.kind, values.path + map}; }
};

/// The wrap of the encoder must be told from motion: a jump has to be less than half of its range.
void check_range(const AxisPlace& place) {
  const int bits = place.axis.encoder.bits;
  const AxisValues& values = place.values;
  const double counts =
      kMaxStepTicks * values.max_velocity * place.period_s() * values.counts_per_unit;
  if (bits == 0 || !(std::ldexp(1.0, bits - 1) <= counts)) return;
  place.units(".encoder")
      .refuse("bits",
              "expected at least " + std::to_string(bits_for(counts)) + " bits, found " +
                  std::to_string(bits) + ": at guard." +
                  (values.rotary ? "max_velocity_rad_s " : "max_velocity_m_s ") +
                  format_number(values.max_velocity) +
                  " a wrap of the encoder could not be told from a jump; lower that limit, or use "
                  "more bits");
}

void add_axis(const AxisPlace& place) {
  check_range(place);
  const AxisValues& values = place.values;
  const Encoder& encoder = place.axis.encoder;
  const double latency_ticks = place.device.device.latency_s / place.period_s();
  // A latency of whole ticks may come out a rounding below them.
  const double whole = std::floor(latency_ticks + 1e-9);
  place.spec().axes.push_back({.unit_per_raw = (encoder.reversed ? -1 : 1) / values.counts_per_unit,
                               .offset = values.offset,
                               .modulus_raw = encoder.bits > 0 ? std::ldexp(1.0, encoder.bits) : 0,
                               .max_effort = values.max_effort,
                               .max_velocity = values.max_velocity,
                               .max_step = kMaxStepTicks * values.max_velocity * place.period_s(),
                               .min_damping = std::max(0.0, values.surely_dissipated()),
                               .delay_share = std::max(0.0, latency_ticks - whole),
                               .delay_ticks = static_cast<std::uint16_t>(whole)});
}

void add_stuck_watch(const AxisPlace& place) {
  if (!place.axis.encoder.stuck_s) return;
  const double limit =
      place.values.rotary ? place.values.max_effort : place.device.guard.max_force_N;
  place.spec().stuck_watches.push_back(
      {.axis = place.index,
       .ticks = ticks_of(*place.axis.encoder.stuck_s, place.period_s()),
       .min_effort = kStuckEffortShare * limit});
}

void add_velocity(const AxisPlace& place) {
  const Velocity& velocity = place.axis.velocity;
  const auto window = static_cast<std::uint16_t>(velocity.window);
  build::ProgramSpec& spec = place.spec();
  switch (velocity.estimator) {
    case Estimator::backward_difference:
      break;
    case Estimator::low_pass:
      check_cutoff(place.compilation, place.values.path + ".velocity", velocity.cutoff_Hz);
      spec.low_passes.push_back(build::low_pass(place.index, velocity.cutoff_Hz, spec.period_s));
      break;
    case Estimator::least_squares:
      if (velocity.degree >= velocity.window) {
        place.units(".velocity")
            .refuse("degree", "expected less than window, " + std::to_string(velocity.window) +
                                  ", found " + std::to_string(velocity.degree));
        break;
      }
      spec.least_squares.push_back(build::least_squares(
          place.index, window, static_cast<std::uint16_t>(velocity.degree), spec.period_s));
      break;
    case Estimator::foaw:
      spec.foaws.push_back(
          build::foaw(place.index, window, velocity.noise_counts / place.values.counts_per_unit));
      break;
    case Estimator::alpha_beta_gamma:
      spec.alpha_beta_gammas.push_back(
          build::alpha_beta_gamma(place.index, velocity.bandwidth_rad_s, spec.period_s));
      break;
  }
}

/// The effort of a search, within a quarter of the actuator's; a hard stop is not found without.
double search_effort(const AxisPlace& place, const AxisUnits& units) {
  const Homing& homing = place.axis.homing;
  const Form linear{"search_force_N", homing.search_force_N};
  const Form rotary{"search_torque_Nm", homing.search_torque_Nm};
  const double effort = units.optional(linear, rotary, 0);
  const double most = kSearchEffortShare * place.values.max_effort;
  const char* key = units.key(linear, rotary);
  if (homing.by == HomingMethod::hard_stop && effort == 0) {
    units.refuse(key, std::string("missing; expected here: ") + key +
                          ", the effort of the search, its sign towards the stop");
  }
  if (std::abs(effort) > most) {
    units.refuse(key, "expected at most a quarter of the actuator's, " + format_number(most) + " " +
                          effort_unit(units.rotary()) + " either way, found " +
                          format_number(effort));
  }
  return effort;
}

void add_homing(const AxisPlace& place) {
  const Homing& homing = place.axis.homing;
  const AxisUnits units = place.units(".homing");
  control::HomingPlan plan{.axis = place.index};
  plan.position = units.optional(Form{"position_m", homing.position_m},
                                 Form{"position_rad", homing.position_rad}, 0);
  plan.effort = search_effort(place, units);
  plan.effort_per_tick = std::abs(plan.effort) * place.period_s() / kSearchRise_s;
  plan.velocity = units.optional(Form{"search_velocity_m_s", homing.search_velocity_m_s},
                                 Form{"search_velocity_rad_s", homing.search_velocity_rad_s},
                                 units.rotary() ? kSearchVelocity_rad_s : kSearchVelocity_m_s);
  plan.still_ticks = ticks_of(homing.still_s, place.period_s());
  plan.max_ticks = ticks_of(homing.timeout_s, place.period_s());
  switch (homing.by) {
    case HomingMethod::none:
      return;
    case HomingMethod::device:
      plan.by = control::HomingBy::device;
      break;
    case HomingMethod::index:
      plan.by = control::HomingBy::index;
      break;
    case HomingMethod::hard_stop:
      plan.by = control::HomingBy::hard_stop;
      break;
  }
  place.spec().homings.push_back(plan);
}

void add_travel(const AxisPlace& place) {
  if (!place.axis.travel) return;
  const Travel& travel = *place.axis.travel;
  const AxisUnits units = place.units(".travel");
  const Form max_linear{"max_m", travel.max_m};
  const Form max_rotary{"max_rad", travel.max_rad};
  const control::TravelPlan plan{
      .axis = place.index,
      .min = units.required(Form{"min_m", travel.min_m}, Form{"min_rad", travel.min_rad}),
      .max = units.required(max_linear, max_rotary),
      .stiffness = units.optional(Form{"stiffness_N_m", travel.stiffness_N_m},
                                  Form{"stiffness_Nm_rad", travel.stiffness_Nm_rad}, 0),
      .max_effort =
          units.optional(Form{"max_force_N", travel.max_force_N},
                         Form{"max_torque_Nm", travel.max_torque_Nm}, place.values.max_effort),
      .margin =
          units.required(Form{"margin_m", travel.margin_m}, Form{"margin_rad", travel.margin_rad})};
  if (plan.max <= plan.min) {
    units.refuse(units.key(max_linear, max_rotary), "expected more than the lower end, " +
                                                        format_number(plan.min) + ", found " +
                                                        format_number(plan.max));
  }
  place.spec().travels.push_back(plan);
}

void add_thermal(const AxisPlace& place) {
  if (!place.values.continuous) return;
  place.spec().thermals.push_back(
      {.axis = place.index,
       .continuous = *place.values.continuous,
       .share = -std::expm1(-place.period_s() / place.axis.actuator.thermal_time_s)});
}

/// The weight of the axis itself, by an effort that its position alone decides.
void add_gravity(const AxisPlace& place) {
  const Compensation& weight = place.axis.compensation;
  const AxisUnits units = place.units(".compensation");
  const double constant =
      units.optional(Form{"gravity_N", weight.gravity_N}, Form{"gravity_Nm", weight.gravity_Nm}, 0);
  if (weight.swing_Nm != 0 && !units.rotary()) {
    units.refuse("swing_Nm", "a linear axis has no pendulum; give its weight as gravity_N");
  }
  if (constant == 0 && weight.swing_Nm == 0) return;
  place.spec().gravity_axes.push_back({.axis = place.index,
                                       .constant = constant,
                                       .swing = weight.swing_Nm,
                                       .phase = weight.swing_phase_rad});
}

void add_friction(const AxisPlace& place) {
  control::FrictionAxis friction = place.values.friction;
  if (friction.viscous == 0 && friction.coulomb == 0) return;
  friction.axis = place.index;
  place.spec().frictions.push_back(friction);
}

}  // namespace

void check_cutoff(Compilation& compilation, const std::string& path, double cutoff_Hz) {
  const double half_rate_Hz = 0.5 / compilation.spec.period_s;
  if (cutoff_Hz < half_rate_Hz) return;
  compilation.refuse(path + ".cutoff_Hz", "expected less than half the loop's rate, " +
                                              format_number(half_rate_Hz) + " Hz, found " +
                                              format_number(cutoff_Hz) + " Hz");
}

void compile_axes(Compilation& compilation, const DevicePlace& device) {
  for (std::size_t i = 0; i < device.axes.size(); ++i) {
    const AxisPlace place{compilation, device, device.device.axes[i], device.axes[i],
                          device.axis(i)};
    add_axis(place);
    add_stuck_watch(place);
    add_velocity(place);
    add_homing(place);
    add_travel(place);
    add_thermal(place);
    add_gravity(place);
    add_friction(place);
  }
}

}  // namespace hapticd::config
