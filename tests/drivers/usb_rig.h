// The daemon's USB device on an emulated one: a config is compiled, its device speaks through a wire to electronics that
// have encoders and decoders of their own, and the whole cycle runs in virtual time.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/compile.h"
#include "config/error.h"
#include "daemon/cycle.h"
#include "drivers/usb/usb_device.h"
#include "tests/drivers/virtual_usb.h"

namespace hapticd::test {

/// Config, device, emulated electronics and cycle, in virtual time.
class UsbRig {
 public:
  UsbRig(config::Compiled compiled, std::unique_ptr<sim::usb::Device> electronics,
         const std::vector<sim::EmulatedDevice::Joint>& joints,
         const sim::usb::WireOptions& wire = {})
      : compiled_(std::move(compiled)),
        electronics_(std::move(electronics)),
        usb_(*electronics_, wire, started(compiled_.simulated.at(0), joints)),
        device_(*compiled_.usb.at(0), std::make_unique<VirtualHost>(usb_),
                std::make_unique<VirtualRunner>(usb_)),
        cycle_({&device_}, compiled_.program->plan()) {
    period_ns_ = std::llround(1e9 * compiled_.usb[0]->period_s);
    current_ = this;
  }
  ~UsbRig() {
    device_.disconnect();
    current_ = nullptr;
  }

  Result<drivers::DeviceInfo> connect() {
    auto info = device_.connect();
    next_start_ns_ = (usb_.now_ns() / period_ns_ + 2) * period_ns_;
    return info;
  }
  /// One tick, and what comes of it until the next.
  const control::TickOutput& tick() {
    usb_.pass_until(next_start_ns_);
    input.time = {.tick = ++tick_, .start_ns = next_start_ns_, .deadline_ns = next_start_ns_};
    cycle_.run(*compiled_.program, input, &UsbRig::clock, nullptr);
    input.clear_fault = false;
    next_start_ns_ += period_ns_;
    usb_.pass_until(next_start_ns_ - 1);
    return cycle_.output();
  }
  /// Ticks until it is so; false: not within `most`.
  template <class Condition>
  bool until(Condition&& condition, int most = 3000) {
    for (int i = 0; i < most; ++i) {
      if (condition()) return true;
      tick();
    }
    return condition();
  }
  void ticks(int count) {
    for (int i = 0; i < count; ++i) tick();
  }
  /// The loop hangs: time passes for the device alone.
  void stand_still(std::int64_t duration_ns) {
    usb_.pass_until(usb_.now_ns() + duration_ns);
    next_start_ns_ = (usb_.now_ns() / period_ns_ + 1) * period_ns_;
    tick_ += duration_ns / period_ns_;
  }

  control::Mode mode() const { return cycle_.output().mode; }
  bool enabled() const { return mode() == control::Mode::enabled; }
  bool faulted() const { return mode() == control::Mode::fault; }
  std::string fault_text() const { return device_.fault_text(); }
  std::string status_text() const { return device_.status_text(); }
  /// The largest torque that a motor makes now.
  double torque() const {
    double most = 0;
    for (std::size_t i = 0; i < electronics_->motors(); ++i)
      most = std::max(most, std::abs(electronics_->motor(i).torque()));
    return most;
  }
  /// What an encoder would read now, without its wrapping.
  double counts(std::size_t axis) const {
    const auto& options = compiled_.usb.at(0)->axes[axis];
    return options.counts_per_unit *
           (usb_.body().position(axis) - compiled_.simulated.at(0).axes[axis].zero_m);
  }
  sim::usb::Wire& wire() { return usb_.wire; }
  usb::UsbDevice& device() { return device_; }
  daemon::Cycle& cycle() { return cycle_; }
  build::Program& program() { return *compiled_.program; }
  const config::Compiled& compiled() const { return compiled_; }
  const AxisSample& sample(std::size_t axis = 0) const { return cycle_.samples()[axis]; }
  std::int64_t now_ns() const { return usb_.now_ns(); }

  daemon::CycleInput input;

 private:
  static std::unique_ptr<sim::EmulatedDevice> started(
      const sim::DeviceOptions& truth, const std::vector<sim::EmulatedDevice::Joint>& joints) {
    auto body = std::make_unique<sim::EmulatedDevice>(truth, joints, 250e-6);
    if (auto done = body->start(); !done) throw std::runtime_error(done.error().text);
    return body;
  }
  static std::int64_t clock() noexcept { return current_->usb_.now_ns(); }
  static inline UsbRig* current_ = nullptr;

  config::Compiled compiled_;
  std::unique_ptr<sim::usb::Device> electronics_;
  VirtualUsb usb_;
  usb::UsbDevice device_;
  daemon::Cycle cycle_;
  std::int64_t next_start_ns_ = 0, period_ns_ = 0, tick_ = 0;
};

}  // namespace hapticd::test
