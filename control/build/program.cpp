#include "control/build/program.h"

#include <utility>

#include "control/record.h"

namespace hapticd::build {

Program::Program(ProgramSpec spec) : spec_(std::move(spec)) {
  std::size_t coordinates = 0;
  for (const control::DevicePlan& device : spec_.devices) {
    coordinates += device.coordinates;
    for (std::uint16_t i = 0; i < device.axes; ++i) {
      cartesian_axes_.push_back({static_cast<std::uint16_t>(device.first_axis + i),
                                 static_cast<std::uint16_t>(device.first_coordinate + i)});
    }
  }

  const std::size_t axes = spec_.axes.size();
  axis_states_.resize(axes);
  recorded_.assign(3 * axes + 3 * coordinates, 0.0);
  v_.assign(coordinates, 0.0);
  ramp_.assign(spec_.devices.size(), 0.0);

  plan_ = {.period_s = spec_.period_s,
           .rate_Hz = 1.0 / spec_.period_s,
           .axes = spec_.axes,
           .devices = spec_.devices,
           .cartesian_axes = cartesian_axes_,
           .stuck_watches = spec_.stuck_watches,
           .planes = spec_.planes,
           .coordinates = coordinates,
           .record = control::record_layout(spec_.axes.size(), coordinates, spec_.devices.size())};
  state_.axes = axis_states_;
  state_.recorded = recorded_;
  auto next = recorded_.begin();
  const auto take = [&next](std::size_t count) {
    const std::span<double> part(next, count);
    next += static_cast<std::ptrdiff_t>(count);
    return part;
  };
  for (auto* part : {&state_.q, &state_.qd, &state_.effort}) *part = take(axes);
  for (auto* part : {&state_.x, &state_.scene_force, &state_.force}) *part = take(coordinates);
  state_.v = v_;
  state_.ramp = ramp_;
}

}  // namespace hapticd::build
