// A program that names every kind of work there is: what holds for it holds for all that configs
// can ask for.
#pragma once
#include <cmath>

#include "tests/support/full_scene.h"
#include "tests/support/program_fixture.h"

namespace hapticd::test {

namespace full_detail {

inline control::ObserverPlan observer(std::uint16_t source, std::uint16_t device, double mass,
                                      double damping, bool command, bool hand) {
  const double share = 1 - std::exp(-2 * 3.141592653589793 * 10 * 1e-3);
  return {.source = source,
          .device = device,
          .inertia = mass * 1e6,
          .damping = damping * 1e3,
          .command_share = command ? 1.0 : 0.0,
          .hand_share = hand ? 1.0 : 0.0,
          .share = share,
          .second_share = share,
          .max_output = 3,
          .blend_per_tick = 0.01,
          .extra_delay = 1};
}

/// Appends `count` axes and a device with as many `coordinates` as its contact has.
inline void add_device(build::ProgramSpec& spec, std::uint16_t count, std::uint16_t coordinates) {
  control::DevicePlan device = spec.devices.front();
  device.first_axis = static_cast<std::uint16_t>(spec.axes.size());
  device.first_coordinate = static_cast<std::uint16_t>(spec.coordinate_names.size());
  device.axes = count;
  device.coordinates = coordinates;
  const std::string name = "device" + std::to_string(spec.devices.size());
  spec.devices.push_back(device);
  spec.device_names.push_back(name);
  for (int i = 0; i < count; ++i) {
    spec.axes.push_back(spec.axes.front());
    spec.axis_names.push_back(name + ".j" + std::to_string(i));
  }
  for (int i = 0; i < coordinates; ++i)
    spec.coordinate_names.push_back(name + "." + std::string(1, static_cast<char>('x' + i)));
}

inline control::Linkage linkage(const build::ProgramSpec& spec, double max_condition) {
  const control::DevicePlan& device = spec.devices.back();
  return {.device = static_cast<std::uint16_t>(spec.devices.size() - 1),
          .first_axis = device.first_axis,
          .axes = device.axes,
          .first_coordinate = device.first_coordinate,
          .coordinates = device.coordinates,
          .origin = {0.01, 0.02, 0.03},
          .turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}},
          .max_condition = max_condition,
          .rotary = true};
}

inline void add_five_bar(build::ProgramSpec& spec) {
  add_device(spec, 2, 2);
  spec.linkages.push_back(linkage(spec, 20));
  spec.five_bars = {{.linkage = static_cast<std::uint16_t>(spec.linkages.size() - 1),
                     .link_m = 0.2,
                     .base_m = 0.1}};
  const std::size_t first = spec.devices.back().first_axis;
  spec.axes[first].offset = 2.25;
  spec.axes[first + 1].offset = 0.89;
  const auto device = static_cast<std::uint16_t>(spec.devices.size() - 1);
  for (std::uint16_t i = 0; i < 2; ++i) {
    const auto coordinate = static_cast<std::uint16_t>(spec.devices.back().first_coordinate + i);
    spec.contact_observers.push_back(observer(coordinate, device, 0.0185, 0.02, true, i == 1));
  }
}

inline void add_delta(build::ProgramSpec& spec) {
  add_device(spec, 3, 3);
  spec.linkages.push_back(linkage(spec, 20));
  control::Delta delta{.linkage = static_cast<std::uint16_t>(spec.linkages.size() - 1),
                       .a = 0.060,
                       .b = 0.1025,
                       .c = 0.01443,
                       .d = 0.01125,
                       .e = 0.01125,
                       .f = -0.025,
                       .r = 0.04,
                       .s = -0.02309};
  const double degrees[] = {105, -15, -135};
  for (std::size_t leg = 0; leg < 3; ++leg) {
    const double angle = degrees[leg] * 3.141592653589793 / 180;
    delta.leg[leg] = {std::cos(angle), std::sin(angle)};
    spec.axes[spec.devices.back().first_axis + leg].offset = 0.28253320133598325;
  }
  delta.home = {0, 0, 0.11};
  spec.deltas = {delta};
}

inline void add_serial(build::ProgramSpec& spec) {
  add_device(spec, 6, 3);
  spec.linkages.push_back(linkage(spec, 1e6));
  control::Serial chain{.linkage = static_cast<std::uint16_t>(spec.linkages.size() - 1),
                        .joints = 6,
                        .gravity = {0, 0, -9.81}};
  for (std::size_t i = 0; i < 6; ++i) {
    chain.joint[i] = {.theta = 0.3 * static_cast<double>(i),
                      .d = 0.05,
                      .a = 0.1,
                      .cos_twist = std::cos(0.7),
                      .sin_twist = std::sin(0.7),
                      .mass = 0.05,
                      .center = {0.02, 0, 0}};
  }
  spec.serials = {chain};
}

}  // namespace full_detail

/// Four devices: three Cartesian axes with everything that an axis can have, a five-bar with
/// contact observers, a delta, a serial arm of six joints. Each meets a wall and every kind of
/// object; the first is coupled and tied to the second, the third has a general V(z) and a network.
inline build::ProgramSpec full_spec() {
  using namespace full_detail;
  build::ProgramSpec spec = spec_of(3);
  const double share = 1 - std::exp(-2 * 3.141592653589793 * 200 * 1e-3);
  for (control::AxisPlan& axis : spec.axes) axis.min_damping = 1;
  spec.axes[1].delay_ticks = 2;
  spec.axes[1].delay_share = 0.3;
  spec.low_passes = {{.axis = 0, .share = share}};
  control::LeastSquaresPlan line{.axis = 1, .window = 4};
  for (std::size_t i = 1; i < 4; ++i) line.weights[i] = -100.0 * static_cast<double>(i);
  spec.least_squares = {line};
  spec.foaws = {{.axis = 2, .window = 16, .noise = 1e-6}};
  spec.homings = {{.axis = 2,
                   .by = control::HomingBy::device,
                   .velocity = 0.02,
                   .still_ticks = 100,
                   .max_ticks = 1000}};
  spec.axis_observers = {observer(0, 0, 0.05, 1, true, false), observer(1, 0, 0.05, 1, true, true),
                         observer(2, 0, -0.02, -0.5, false, false)};
  spec.force_sensors = {{.device = 0, .channels = 3, .turn = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}}};
  spec.gravity_axes = {{.axis = 1, .constant = 0.3, .swing = 0.1, .phase = 0.2}};
  spec.gravity_tips = {{.device = 0, .weight = {0, 0, 0.5}}};
  spec.frictions = {{.axis = 0, .viscous = 0.1, .coulomb = 0.02, .smooth = 0.05}};
  spec.travels = {
      {.axis = 0, .min = -0.05, .max = 0.05, .stiffness = 200, .max_effort = 2, .margin = 0.02}};
  spec.power_limits = {{.device = 0, .max_W = 2}};
  spec.thermals = {{.axis = 0, .continuous = 3, .share = 1e-3}};
  spec.workspaces = {{.device = 0, .min = {-0.1, -0.1, -0.1}, .max = {0.1, 0.1, 0.1}}};
  spec.enable_inputs = {{.device = 0, .mask = 1, .active = 1, .estop = false},
                        {.device = 0, .mask = 2, .active = 0, .estop = true}};
  spec.passivity_controllers = {
      {.device = 0, .budget = 2e-3, .credit = 0.5, .leak = 1e-5, .rise = 0.01}};
  add_five_bar(spec);
  add_delta(spec);
  add_serial(spec);
  spec.alpha_beta_gammas = {{.axis = 3, .alpha = 0.9, .beta = 400, .gamma = 1e5}};
  for (const control::DevicePlan& device : spec.devices) {
    control::PlaneContact plane = wall(1000, 1, device.coordinates);
    plane.first_coordinate = device.first_coordinate;
    spec.planes.push_back(plane);
  }
  add_full_scene(spec);
  return spec;
}

}  // namespace hapticd::test
