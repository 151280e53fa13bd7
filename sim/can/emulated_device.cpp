#include "sim/can/emulated_device.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

namespace hapticd::sim::can {
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

EmulatedDevice::EmulatedDevice(DeviceOptions truth, std::vector<Motor> motors, double step_s)
    : motors_(std::move(motors)), step_s_(step_s), device_(ideal(std::move(truth), step_s)) {}

Result<void> EmulatedDevice::start() {
  const std::size_t axes = device_.options().axes.size();
  if (motors_.size() != axes) {
    return hapticd::fail(ExitCode::bad_data, "emulated device " + device_.options().name +
                                                 ": expected a motor for " + "each of " +
                                                 std::to_string(axes) + " axes, found " +
                                                 std::to_string(motors_.size()));
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
    move_drives();
    return;
  }
  while (step_end_ns() <= now_ns) step();
  now_ns_ = std::max(now_ns_, now_ns);
  move_drives();
}

std::int64_t EmulatedDevice::step_end_ns() const {
  return start_ns_ + std::llround(1e9 * step_s_ * static_cast<double>(tick_ + 1));
}

void EmulatedDevice::step() {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const Drive& drive = *motors_[i].drive;
    armed_ = armed_ || drive.enabled();
    efforts_[i] = drive.torque_Nm() * 2 * std::numbers::pi * motors_[i].turns_per_unit;
  }
  Aux aux{};
  device_.set_armed(armed_);
  device_.collect(samples_, aux);
  device_.command(efforts_, delivered_);
  now_ns_ = step_end_ns();
  ++tick_;
  device_.request({.tick = tick_, .start_ns = now_ns_, .deadline_ns = now_ns_});
  move_drives();
}

void EmulatedDevice::move_drives() {
  for (std::size_t i = 0; i < motors_.size(); ++i) {
    const Motor& motor = motors_[i];
    motor.drive->move_to(motor.turns_per_unit * position(i) + motor.offset_turns,
                         motor.turns_per_unit * device_.truth(i).velocity_m_s);
  }
}

double EmulatedDevice::position(std::size_t axis) const {
  const std::int64_t stepped_ns =
      start_ns_ + std::llround(1e9 * step_s_ * static_cast<double>(tick_));
  const double since_s = 1e-9 * static_cast<double>(now_ns_ - stepped_ns);
  const Truth& truth = device_.truth(axis);
  return truth.position_m + truth.velocity_m_s * since_s;
}

}  // namespace hapticd::sim::can
