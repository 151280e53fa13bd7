#include "drivers/can/budget.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace hapticd::can {
namespace {

using drivers::Timing;

enum class When : std::uint8_t { command, answer, any };
/// A frame, how often it comes, and in which half of a tick.
struct Use {
  double s = 0;
  double every_s = 0;
  When when = When::any;
};

/// What one drive has on the bus, and what all drives of a device share.
struct Uses {
  std::vector<Use> axis{}, shared{};
};

double classic_s(const DeviceOptions& device, std::size_t size) {
  return worst_classic_bits(size, false) / device.rates.nominal_Hz;
}

Uses odrive_uses(const DeviceOptions& device) {
  const double tick = device.period_s;
  Uses uses{.axis = {{classic_s(device, 4), tick, When::command},  // torque
                     {classic_s(device, 8), device.heartbeat_every_s}}};
  if (device.timing == Timing::in_phase) {
    uses.axis.push_back({classic_s(device, 0), tick, When::answer});
    uses.axis.push_back({classic_s(device, 8), tick, When::answer});
  } else {
    uses.axis.push_back({classic_s(device, 8), device.estimates_every_s});
  }
  return uses;
}

Uses moteus_uses(const DeviceOptions& device) {
  const auto s = [&](std::size_t size) { return worst_fd_s(size, true, device.rates); };
  constexpr std::size_t kCommand = 48, kQuestion = 12, kReply = 24;
  Uses uses{.axis = {{s(kCommand), device.period_s, When::command},
                     {s(kReply), device.period_s, When::answer}}};
  if (device.timing == Timing::in_phase)
    uses.axis.push_back({s(kQuestion), device.period_s, When::answer});
  return uses;
}

Uses cia402_uses(const DeviceOptions& device) {
  const double tick = device.period_s;
  return {.axis = {{classic_s(device, 4), tick, When::command},
                   {classic_s(device, 8), tick, When::answer},
                   {classic_s(device, 1), device.heartbeat_every_s}},
          .shared = {{classic_s(device, 0), tick, When::answer},
                     {classic_s(device, 1), std::max(tick, device.watchdog_s / 3), When::answer}}};
}

Uses uses_of(const DeviceOptions& device) {
  switch (device.protocol) {
    case Protocol::odrive:
      return odrive_uses(device);
    case Protocol::moteus:
      return moteus_uses(device);
    case Protocol::cia402:
      return cia402_uses(device);
  }
  return {};
}

double share_of(const std::vector<Use>& uses) {
  double share = 0;
  for (const Use& use : uses) share += use.s / use.every_s;
  return share;
}
double sum_of(const std::vector<Use>& uses, std::initializer_list<When> wanted) {
  double sum = 0;
  for (const Use& use : uses)
    for (const When when : wanted) sum += use.when == when ? use.s : 0;
  return sum;
}
double longest_own(const std::vector<Use>& uses) {
  double longest = 0;
  for (const Use& use : uses) longest = std::max(longest, use.when == When::any ? use.s : 0);
  return longest;
}

std::size_t axes_on(const DeviceOptions& device, const std::string& interface) {
  return static_cast<std::size_t>(
      std::ranges::count(device.drives, interface, &DriveOptions::interface));
}

BusLoad load_of(const std::vector<DeviceOptions>& devices, const std::string& interface) {
  BusLoad load{.interface = interface};
  double share_of_axis = 0, shared = 0, own_s = 0;
  for (const DeviceOptions& device : devices) {
    const std::size_t axes = axes_on(device, interface);
    if (axes == 0) continue;
    const Uses uses = uses_of(device);
    const auto count = static_cast<double>(axes);
    if (load.axes == 0) share_of_axis = share_of(uses.axis);
    load.axes += axes;
    shared += share_of(uses.shared);
    load.share += count * share_of(uses.axis) + share_of(uses.shared);
    const auto sum = [&](std::initializer_list<When> wanted) {
      return count * sum_of(uses.axis, wanted) + sum_of(uses.shared, wanted);
    };
    load.busiest_s += sum({When::command, When::answer, When::any});
    load.answers_s += sum({When::answer});
    load.commands_s += sum({When::command, When::any});
    own_s = std::max(own_s, longest_own(uses.axis));
  }
  load.answers_s += own_s;
  load.axes_that_fit =
      static_cast<std::size_t>(std::max(0.0, std::floor((kMostLoad - shared) / share_of_axis)));
  return load;
}

/// From collect to the frames of the command.
constexpr double kHost_s = 50e-6;
/// That the loop may wake late, and its questions go out, before an answer counts as late.
constexpr double kWake_s = 50e-6;
/// Clocks of drives run off by no more.
constexpr double kDrift = 1e-3;

}  // namespace

std::vector<BusLoad> bus_loads(const std::vector<DeviceOptions>& devices) {
  std::vector<BusLoad> loads;
  for (const DeviceOptions& device : devices) {
    for (const DriveOptions& drive : device.drives) {
      if (std::ranges::find(loads, drive.interface, &BusLoad::interface) == loads.end())
        loads.push_back(load_of(devices, drive.interface));
    }
  }
  return loads;
}

BusLoad worst_of(const DeviceOptions& device, const std::vector<BusLoad>& loads) {
  BusLoad worst;
  for (const BusLoad& load : loads) {
    if (axes_on(device, load.interface) == 0) continue;
    worst.busiest_s = std::max(worst.busiest_s, load.busiest_s);
    worst.answers_s = std::max(worst.answers_s, load.answers_s);
    worst.commands_s = std::max(worst.commands_s, load.commands_s);
  }
  return worst;
}

double worst_answer_s(const DeviceOptions& device, const BusLoad& bus) {
  return kWake_s + device.turnaround_s + bus.answers_s;
}

double worst_reply_s(const DeviceOptions& device, const BusLoad& bus) {
  return device.collect_s + kWake_s + kHost_s + bus.busiest_s + device.turnaround_s;
}

double worst_sample_age_s(const DeviceOptions& device, const BusLoad& bus) {
  switch (device.timing) {
    case Timing::in_phase:  // of one that came first, when the last one comes at the deadline
      return device.collect_s;
    case Timing::free_running:  // since it came; what it took on the bus is in the latency
      return device.estimates_every_s * (1 + kDrift) + bus.busiest_s;
    case Timing::reply_to_command:  // and the loop may wake late by a tenth
      return 1.1 * device.period_s;
  }
  return 0;
}

double worst_latency_s(const DeviceOptions& device, const BusLoad& bus) {
  const double rest_s = worst_sample_age_s(device, bus) + kHost_s + device.drive_delay_s;
  switch (device.timing) {
    case Timing::in_phase:
      return rest_s + bus.commands_s;
    case Timing::
        free_running:  // on its way here, and waiting for devices that are sampled in phase
      return rest_s + 2 * bus.busiest_s + device.collect_s;
    case Timing::reply_to_command:
      return rest_s + bus.busiest_s + device.collect_s;
  }
  return rest_s;
}

}  // namespace hapticd::can
