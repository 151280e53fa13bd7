#include "daemon/cost_parts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <variant>

namespace hapticd::daemon {
namespace {

template <class... Lists>
void clear(Lists&... lists) {
  (lists.clear(), ...);
}

/// Joints of a linkage somewhere in its workspace, into q of all axes.
void set_home(const build::ProgramSpec& spec, std::vector<double>& q) {
  for (const control::FiveBar& bars : spec.five_bars) {
    const std::array<double, 3> tip{0, 1.4 * bars.link_m, 0};
    (void)control::joints_of(bars, tip, &q[spec.linkages[bars.linkage].first_axis]);
  }
  for (const control::Delta& delta : spec.deltas)
    (void)control::joints_of(delta, delta.home, &q[spec.linkages[delta.linkage].first_axis]);
}

}  // namespace

config::Checked<build::ProgramSpec> with_objects(const config::Document& document,
                                                 std::vector<config::SceneObject> objects) {
  config::Document part{.path = document.path,
                        .config = document.config,
                        .coupling_places = document.coupling_places};
  part.config.scene = std::move(objects);
  return config::compile(std::move(part)).map([](const config::Compiled& compiled) {
    return compiled.program->spec();
  });
}

std::vector<config::SceneObject> networks(const config::Config& config) {
  std::vector<config::SceneObject> found;
  for (const config::SceneObject& object : config.scene) {
    if (std::holds_alternative<config::Network>(object)) found.push_back(object);
  }
  return found;
}

build::ProgramSpec without_objects(build::ProgramSpec spec) {
  clear(spec.planes, spec.encounters);
  return spec;
}

build::ProgramSpec without_scene(build::ProgramSpec spec) {
  clear(spec.planes, spec.contacts, spec.encounters, spec.coupling, spec.networks, spec.sharpen);
  return spec;
}

build::ProgramSpec without_observers(build::ProgramSpec spec) {
  clear(spec.axis_observers, spec.contact_observers);
  return spec;
}

build::ProgramSpec without_homing(build::ProgramSpec spec) {
  clear(spec.homings);
  return spec;
}

build::ProgramSpec with_ideal_devices(build::ProgramSpec spec) {
  clear(spec.axes, spec.stuck_watches, spec.homings, spec.low_passes, spec.least_squares,
        spec.foaws, spec.alpha_beta_gammas, spec.cartesian_axes, spec.linkages, spec.linear_maps,
        spec.five_bars, spec.deltas, spec.serials, spec.force_sensors, spec.gravity_axes,
        spec.gravity_tips, spec.frictions, spec.axis_observers, spec.contact_observers,
        spec.travels, spec.power_limits, spec.thermals, spec.workspaces, spec.enable_inputs,
        spec.passivity_controllers, spec.axis_names, spec.rotary);
  for (control::DevicePlan& device : spec.devices) {
    device.first_axis = device.first_coordinate;
    device.axes = device.coordinates;
    device.ramp_per_tick = 1;
    for (std::size_t i = 0; i < device.coordinates; ++i)
      spec.axes.push_back({.max_effort = 1e9, .max_velocity = 1e12, .max_step = 1e12});
  }
  spec.axis_names = spec.coordinate_names;
  return spec;
}

Pose working_pose(const build::ProgramSpec& spec) {
  std::vector<double> q(spec.axes.size(), 0.0);
  set_home(spec, q);
  for (const control::TravelPlan& travel : spec.travels) {
    const bool free = std::none_of(spec.linkages.begin(), spec.linkages.end(), [&](const auto& at) {
      return travel.axis >= at.first_axis && travel.axis < at.first_axis + at.axes;
    });
    if (free) q[travel.axis] = 0.5 * (travel.min + travel.max);
  }
  Pose pose;
  for (std::size_t i = 0; i < spec.axes.size(); ++i) {
    const control::AxisPlan& axis = spec.axes[i];
    const double step = std::min(1e-4, 0.5 * axis.max_velocity * spec.period_s);
    pose.raw.push_back((q[i] - axis.offset) / axis.unit_per_raw);
    pose.step.push_back(step / std::abs(axis.unit_per_raw));
  }
  return pose;
}

}  // namespace hapticd::daemon
