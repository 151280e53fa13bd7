// An axis of the config in SI units, whatever its kind: m and N, or rad and N m.
#pragma once
#include <optional>
#include <string>

#include "config/effective_guard.h"
#include "config/schema_axis.h"
#include "control/observer/compensation.h"

namespace hapticd::config {

class Compilation;

/// A step of more than this many ticks at full speed is a jump.
inline constexpr double kMaxStepTicks = 10;

/// What is known of the dynamics along an axis, or along a coordinate of a contact.
struct ModelValues {
  double inertia = 0;  ///< kg or kg m^2
  double damping = 0;  ///< N s/m or N m s/rad
  double coulomb = 0;  ///< N or N m
  double inertia_uncertainty = 0;
  double damping_uncertainty = 0;
  double least_damping() const { return damping * (1 - damping_uncertainty); }
};

struct AxisValues {
  std::string path;  ///< "devices[0].axes[1]"
  bool rotary = false;
  double counts_per_unit = 0;        ///< per m or rad, > 0
  double offset = 0;                 ///< m or rad
  double max_effort = 0;             ///< N or N m
  double max_velocity = 0;           ///< m/s or rad/s
  std::optional<double> continuous;  ///< N or N m: what the motor bears for ever
  std::optional<ModelValues> model;
  control::FrictionAxis friction;  ///< its compensation; all 0: none

  /// Most that friction compensation adds per speed [N s/m or N m s/rad], at rest.
  double friction_slope() const { return friction.viscous + friction.coulomb / friction.smooth; }
  /// What is left of the least damping beside friction compensation; 0 without a model.
  double surely_dissipated() const { return model ? model->least_damping() - friction_slope() : 0; }
};

/// Reports keys of the wrong kind, missing ones, and compensation that is more than the axis bears.
AxisValues axis_values(Compilation& compilation, const Axis& axis, const std::string& path,
                       const EffectiveGuard& guard);

// The units of an axis for people.
inline const char* position_unit(bool rotary) {
  return rotary ? "rad" : "m";
}
inline const char* effort_unit(bool rotary) {
  return rotary ? "N m" : "N";
}
inline const char* damping_unit(bool rotary) {
  return rotary ? "N m s/rad" : "N s/m";
}

}  // namespace hapticd::config
