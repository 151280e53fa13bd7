// A drive that a thread of this process emulates on a CAN interface of the kernel, in real time.
#pragma once
#include <linux/can.h>
#include <poll.h>
#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "drivers/can/options.h"
#include "sim/can/cia402_drive.h"
#include "sim/can/emulated_bus.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"
#include "tests/vm/kernel_can.h"

namespace hapticd::test {

inline constexpr std::uint8_t kNode = 3;
inline constexpr double kCountsPerTurn = 16384;
inline constexpr double kStandsAt_turns = 0.25;

/// This thread before all that is less urgent, as the daemon's loop is; 0: as any other.
inline void run_at(int priority) {
  const sched_param wanted{.sched_priority = priority};
  (void)pthread_setschedparam(pthread_self(), priority > 0 ? SCHED_FIFO : SCHED_OTHER, &wanted);
}

/// One axis at 1 kHz, 20 turns of the motor a metre.
inline can::DeviceOptions one_axis(can::Protocol protocol, drivers::Timing timing,
                                   const std::string& interface) {
  can::DeviceOptions options;
  options.name = "arm";
  options.protocol = protocol;
  options.timing = timing;
  options.collect_s = 0.7e-3;
  options.worst_sample_age_s = timing == drivers::Timing::free_running ? 1.6e-3 : 1.2e-3;
  options.drives.push_back({.axis = "arm.x",
                            .interface = interface,
                            .node = kNode,
                            .counts_per_unit = 20 * kCountsPerTurn,
                            .counts_per_turn = kCountsPerTurn,
                            .max_effort = 8});
  return options;
}

class EmulatedDrive {
 public:
  EmulatedDrive(const can::DeviceOptions& device, const std::string& interface)
      : socket_(interface, true),
        drive_(make(device)),
        bus_(socket_.descriptor(), {}),
        thread_([this] { run(); }) {}
  EmulatedDrive(const EmulatedDrive&) = delete;
  EmulatedDrive& operator=(const EmulatedDrive&) = delete;
  ~EmulatedDrive() {
    ends_ = true;
    thread_.join();
  }

  bool enabled() {
    const std::lock_guard lock(mutex_);
    return drive_->enabled();
  }
  double torque_Nm() {
    const std::lock_guard lock(mutex_);
    return drive_->torque_Nm();
  }

 private:
  static std::unique_ptr<sim::can::Drive> make(const can::DeviceOptions& device) {
    const std::int64_t start_ns = now_ns();
    switch (device.protocol) {
      case can::Protocol::odrive: {
        sim::can::OdriveOptions options;
        options.node = kNode;
        options.counts_per_turn = kCountsPerTurn;
        if (device.timing == drivers::Timing::in_phase) options.estimates_every_s = 0;
        return std::make_unique<sim::can::OdriveDrive>(options, start_ns);
      }
      case can::Protocol::moteus: {
        sim::can::MoteusOptions options;
        options.servo = kNode;
        options.counts_per_turn = kCountsPerTurn;
        return std::make_unique<sim::can::MoteusDrive>(options, start_ns);
      }
      case can::Protocol::cia402: {
        sim::can::Cia402Options options;
        options.node = kNode;
        options.counts_per_rev = kCountsPerTurn;
        options.rated_torque_Nm = 0.1;
        return std::make_unique<sim::can::Cia402Drive>(options, start_ns);
      }
    }
    return nullptr;
  }

  void run() {
    run_at(85);
    {
      const std::lock_guard lock(mutex_);
      drive_->move_to(kStandsAt_turns, 0);
      bus_.add(*drive_);
    }
    while (!ends_) {
      std::int64_t next_ns = 0;
      {
        const std::lock_guard lock(mutex_);
        bus_.advance(now_ns());
        next_ns = bus_.next_ns();
      }
      can::this_host().wait(socket_.descriptor(), std::min(next_ns, now_ns() + kMillisecond));
    }
  }

  RawSocket socket_;
  std::mutex mutex_;
  std::unique_ptr<sim::can::Drive> drive_;
  sim::can::EmulatedBus bus_;
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

}  // namespace hapticd::test
