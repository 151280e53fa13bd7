// The loop around a CAN device of one axis, as the daemon has it: in real time, at 1 kHz.
#pragma once
#include <cmath>
#include <string>

#include "drivers/can/can_device.h"
#include "tests/vm/emulated_drive.h"

namespace hapticd::test {

class CanLoop {
 public:
  explicit CanLoop(const can::DeviceOptions& options)
      : period_ns_(std::llround(1e9 * options.period_s)),
        collect_ns_(std::llround(1e9 * options.collect_s)),
        device_(options) {
    run_at(80);
  }
  ~CanLoop() { run_at(0); }
  CanLoop(const CanLoop&) = delete;
  CanLoop& operator=(const CanLoop&) = delete;

  /// Empty: done.
  std::string connect() {
    const auto info = device_.connect();
    start_ns_ = now_ns();
    return info ? std::string() : info.error().text;
  }

  void tick(double effort = 0) {
    // What a test did since the last one is no missed tick.
    start_ns_ = std::max(start_ns_ + period_ns_, now_ns() + 100'000);
    sleep_until(start_ns_);
    device_.request(
        {.tick = ++tick_, .start_ns = start_ns_, .deadline_ns = start_ns_ + collect_ns_});
    while (device_.collect({&sample, 1}, aux) == drivers::Collected::waiting &&
           now_ns() < start_ns_ + collect_ns_)
      can::this_host().wait(device_.wait_fd(), start_ns_ + collect_ns_);
    if (aux.faulted) {
      device_.stop();
    } else {
      device_.command({&effort, 1}, {&delivered, 1});
    }
    fresh += sample.freshness == Freshness::fresh ? 1 : 0;
    latest_ns = std::max(latest_ns, now_ns() - start_ns_);
  }
  void ticks(int count, double effort = 0) {
    for (int i = 0; i < count; ++i) tick(effort);
  }
  /// Ticks until the power is on; false: it failed, or took three seconds.
  bool arm() {
    tick();
    device_.set_armed(true);
    for (int i = 0; i < 3000; ++i) {
      tick();
      if (aux.armed) return true;
      if (aux.faulted) return false;
    }
    return false;
  }
  /// As the loop does in a fault, until the operator enables again.
  void disarm() {
    device_.set_armed(false);
    ticks(20);
  }
  std::string fault() const { return std::string(device_.fault_text()); }
  can::CanDevice& device() { return device_; }

  AxisSample sample{};
  Aux aux{};
  double delivered = 0;
  int fresh = 0;               ///< ticks with a fresh sample
  std::int64_t latest_ns = 0;  ///< that a tick ended after its start

 private:
  std::int64_t period_ns_, collect_ns_;
  std::int64_t start_ns_ = 0, tick_ = 0;
  can::CanDevice device_;
};

}  // namespace hapticd::test
