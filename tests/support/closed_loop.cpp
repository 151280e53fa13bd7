#include "tests/support/closed_loop.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace hapticd::test {
namespace {

std::int64_t no_clock() noexcept {
  return 0;
}

}  // namespace

sim::DeviceOptions one_axis_device(double mass_kg, double damping_Ns_m) {
  sim::DeviceOptions device;
  device.name = "device";
  device.axes.push_back({.mass_kg = mass_kg, .damping_Ns_m = damping_Ns_m, .max_effort_N = 1e12});
  return device;
}

build::ProgramSpec program_spec(const sim::DeviceOptions& device, const LoopOptions& options) {
  build::ProgramSpec spec;
  spec.period_s = device.period_s;
  for (const sim::AxisOptions& axis : device.axes) {
    const auto index = static_cast<std::uint16_t>(spec.axes.size());
    spec.axes.push_back(
        {.unit_per_raw = 1 / axis.counts_per_m,
         .modulus_raw = axis.encoder_bits > 0 ? std::ldexp(1.0, axis.encoder_bits) : 0,
         .max_effort = options.max_effort_N,
         .max_velocity = options.max_velocity_m_s,
         .max_step = options.max_step_m,
         .delay_share = options.delay_share,
         .delay_ticks = options.delay_ticks});
    if (options.stuck_ticks > 0) {
      spec.stuck_watches.push_back({index, options.stuck_ticks, options.stuck_min_effort_N});
    }
    spec.axis_names.push_back(device.name + "." + std::to_string(index));
  }
  spec.coordinate_names = spec.axis_names;
  spec.device_names = {device.name};
  const auto axes = static_cast<std::uint16_t>(device.axes.size());
  spec.devices.push_back({.axes = axes,
                          .coordinates = axes,
                          .max_force = options.max_force_N,
                          .max_slew = 1e12,
                          .ramp_per_tick = options.ramp_per_tick,
                          .max_stale_ticks = options.max_stale_ticks});
  if (options.stiffness_N_m > 0) {
    control::PlaneContact wall;
    wall.coordinates = axes;
    wall.normal[0] = -1;
    wall.offset = -options.surface_m;
    wall.stiffness = options.stiffness_N_m;
    wall.damping = options.damping_Ns_m;
    spec.planes.push_back(wall);
  }
  return spec;
}

ClosedLoop::ClosedLoop(const sim::DeviceOptions& device, const LoopOptions& options)
    : device_(device), program_(std::make_unique<build::Program>(program_spec(device, options))) {
  const auto connected = device_.connect();
  if (!connected) throw std::invalid_argument(connected.error().text);
  cycle_ =
      std::make_unique<daemon::Cycle>(std::vector<drivers::Device*>{&device_}, program_->plan());
}

const control::TickOutput& ClosedLoop::run(std::int64_t missed_ticks) {
  tick_ += 1 + missed_ticks;
  const auto period_ns = static_cast<std::int64_t>(std::llround(device_.options().period_s * 1e9));
  daemon::CycleInput input;
  input.time = {tick_, tick_ * period_ns, tick_ * period_ns};
  input.missed_ticks = missed_ticks;
  input.enable = enable;
  input.clear_fault = clear_fault;
  cycle_->run(*program_, input, no_clock, ring);
  return cycle_->output();
}

void ClosedLoop::run_until_ramped() {
  while (program_->state().ramp[0] < 1) run();
}

}  // namespace hapticd::test
