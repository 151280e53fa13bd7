#include "sim/emulated_device.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hapticd::sim {
namespace {

DeviceOptions ideal(DeviceOptions truth, double step_s) {
  truth.period_s = step_s;
  truth.substeps = 1;
  truth.failures.clear();
  for (AxisOptions& axis : truth.axes) {
    axis.counts_per_m = 1e9;
    axis.encoder_bits = 0;
    axis.noise_counts = 0;
    axis.relative = false;
    axis.dac_step_N = 0;
    axis.delay_s = 0;
  }
  return truth;
}

}  // namespace

EmulatedDevice::EmulatedDevice(DeviceOptions truth, std::vector<Joint> joints, double step_s)
    : joints_(std::move(joints)), step_s_(step_s), device_(ideal(std::move(truth), step_s)) {}

Result<void> EmulatedDevice::start() {
  const std::size_t axes = device_.options().axes.size();
  if (joints_.size() != axes) {
    return hapticd::fail(ExitCode::bad_data, "emulated device " + device_.options().name +
                                                 ": expected a motor for " + "each of " +
                                                 std::to_string(axes) + " axes, found " +
                                                 std::to_string(joints_.size()));
  }
  const Result<drivers::DeviceInfo> connected = device_.connect();
  if (!connected) return tl::unexpected<Error>(connected.error());
  samples_.assign(axes, AxisSample{});
  efforts_.assign(axes, 0);
  delivered_.assign(axes, 0);
  running_ = armed_ = false;
  tick_ = 0;
  return {};
}

void EmulatedDevice::advance(std::int64_t now_ns) {
  if (!running_) {
    running_ = true;
    start_ns_ = now_ns_ = now_ns;
    device_.request({});
    move_motors();
    return;
  }
  while (step_end_ns() <= now_ns) step();
  now_ns_ = std::max(now_ns_, now_ns);
  move_motors();
}

std::int64_t EmulatedDevice::step_end_ns() const {
  return start_ns_ + std::llround(1e9 * step_s_ * static_cast<double>(tick_ + 1));
}

void EmulatedDevice::step() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Motor& motor = *joints_[i].motor;
    armed_ = armed_ || motor.enabled();
    efforts_[i] = motor.torque() * joints_[i].effort_per_torque;
  }
  Aux aux{};
  device_.set_armed(armed_);
  device_.collect(samples_, aux);
  device_.command(efforts_, delivered_);
  now_ns_ = step_end_ns();
  ++tick_;
  device_.request({.tick = tick_, .start_ns = now_ns_, .deadline_ns = now_ns_});
  move_motors();
}

void EmulatedDevice::move_motors() {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    const Joint& joint = joints_[i];
    joint.motor->move_to(joint.turns_per_unit * position(i) + joint.offset_turns,
                         joint.turns_per_unit * device_.truth(i).velocity_m_s);
  }
}

double EmulatedDevice::position(std::size_t axis) const {
  const std::int64_t stepped_ns =
      start_ns_ + std::llround(1e9 * step_s_ * static_cast<double>(tick_));
  const double since_s = 1e-9 * static_cast<double>(now_ns_ - stepped_ns);
  const Truth& truth = device_.truth(axis);
  return truth.position_m + truth.velocity_m_s * since_s;
}

}  // namespace hapticd::sim
