// Whether a bus has room for what its devices send in every tick, and how old a sample and a force may get on it. At
// worst: every frame with the most stuff bits, and waiting for all others of its tick.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "drivers/can/options.h"

namespace hapticd::can {

/// Of the period: more is refused.
inline constexpr double kMostLoad = 0.8;

struct BusLoad {
  std::string interface {};
  double share = 0;      ///< of the bus' time, on average over the rarer frames
  double busiest_s = 0;  ///< of one tick that has every frame
  // In phase. Questions and answers with one frame that a drive sends on its own: with more of them an answer may be late,
  // and is then missing. Commands, with all that drives send on their own.
  double answers_s = 0, commands_s = 0;
  std::size_t axes = 0;
  std::size_t axes_that_fit = 0;  ///< of the kind of its first device, within kMostLoad
};
/// By interface, over all devices.
std::vector<BusLoad> bus_loads(const std::vector<DeviceOptions>& devices);

/// The worst of the buses that a device is on.
BusLoad worst_of(const DeviceOptions& device, const std::vector<BusLoad>& loads);

/// At collect [s].
double worst_sample_age_s(const DeviceOptions& device, const BusLoad& bus);
/// From when an axis is measured until the force acts that rests on it.
double worst_latency_s(const DeviceOptions& device, const BusLoad& bus);
/// In phase: from the start of a tick until the last answer.
double worst_answer_s(const DeviceOptions& device, const BusLoad& bus);
/// Reply to command: from the start of a tick until the last answer to its commands, which may go out as late as devices
/// that are sampled in phase make them.
double worst_reply_s(const DeviceOptions& device, const BusLoad& bus);

}  // namespace hapticd::can
