// `hapticctl doctor`: is this machine fit for the loop, and what does it add to the latency? Each
// thing that was looked at is a finding; what is not as it should be says what to do.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "daemon/doctor_machine.h"

namespace hapticd::daemon {

/// Of one device while the loop ran with forces off [s].
struct DeviceTimes {
  std::string name;
  double p50_s = 0, p999_s = 0, max_s = 0;  ///< age of its samples when they were taken
  bool seen = false;                        ///< any sample at all
  bool simulated = false;                   ///< no wire: its whole delay is `sim.delay_s`
  double simulated_delay_s = 0;
  double latency_s = 0;  ///< what the config says
};

/// What was measured.
struct LoopTimes {
  double seconds = 0, period_s = 1e-3;
  std::uint64_t ticks = 0, missed = 0;
  double wake_p50_s = 0, wake_p999_s = 0, wake_max_s = 0;           ///< lateness of wake-ups
  double collect_p50_s = 0, collect_p999_s = 0, collect_max_s = 0;  ///< request until all answered
  double answer_p999_s = 0;  ///< step and command: from the samples to the efforts on the wire
  std::vector<DeviceTimes> devices;
};

/// Pure: what the measured times mean. The host's share of a device's latency is the age of its
/// samples when they are taken, what it may wait for other devices, and the time from there to the
/// efforts on the wire, at p99.9;
/// `latency_s` must cover it, and the whole delay of a simulated device.
std::vector<Finding> judge(const LoopTimes& times);

/// Of a device's latency, the part that the host adds [s].
double host_share_s(const LoopTimes& times, const DeviceTimes& device);
/// Smallest latency_s that the measurement allows [s].
double needed_latency_s(const LoopTimes& times, const DeviceTimes& device);

}  // namespace hapticd::daemon
