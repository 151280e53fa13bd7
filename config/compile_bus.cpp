// Buses of CAN drives: who may share one, whether it has room for all that is on it, and the latency that comes of it.
#include <algorithm>
#include <cmath>

#include "config/compile_drives.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

using drivers::Timing;

/// In whole microseconds, rounded up.
std::string up_to_us(double seconds) {
  return format_number(std::ceil(1e6 * seconds - 1e-3) / 1e6) + " s";
}

/// Two devices may share an interface if nobody takes the frames of the one for those of the other.
void check_neighbours(Compilation& compilation, std::size_t first, std::size_t second) {
  const can::DeviceOptions& a = *compilation.can[first];
  const can::DeviceOptions& b = *compilation.can[second];
  const std::string path = indexed("devices", second);
  for (std::size_t i = 0; i < b.drives.size(); ++i) {
    const can::DriveOptions& drive = b.drives[i];
    const auto on_same = [&](const can::DriveOptions& other) {
      return other.interface == drive.interface && (first != second || &other < &drive);
    };
    for (const can::DriveOptions& other : a.drives) {
      if (!on_same(other)) continue;
      const bool alone =
          a.protocol != b.protocol || (a.protocol == can::Protocol::cia402 && first != second);
      if (alone) {
        compilation.refuse(
            path + ".can.interface",
            drive.interface + " has the drives of device '" + a.name + "' already, which " +
                (a.protocol == b.protocol
                     ? "have a SYNC of their own: make them one device, or use another interface"
                     : "speak another protocol with the same ids: use another interface"));
        return;
      }
      if (a.rates.nominal_Hz != b.rates.nominal_Hz || a.rates.data_Hz != b.rates.data_Hz) {
        compilation.refuse(path + ".can.bitrate_Hz", "another device has other bit rates on " +
                                                         drive.interface + ": '" + a.name + "'");
        return;
      }
      if (b.protocol == can::Protocol::moteus &&
          (a.source == drive.node || b.source == other.node)) {
        compilation.refuse(path + ".can.host_id",
                           "on " + drive.interface + " a drive has the id of a host: '" + a.name +
                               "' and this device; give the hosts ids that no drive has");
        return;
      }
      if (other.node != drive.node) continue;
      compilation.refuse(indexed(path + ".axes", i) + ".can.node",
                         "node " + std::to_string(drive.node) + " on " + drive.interface +
                             " is the drive of '" + other.axis + "' already");
    }
  }
}

void check_load(Compilation& compilation, const can::BusLoad& bus, const std::string& path) {
  if (bus.share <= can::kMostLoad) return;
  compilation.refuse(path, "expected at most 80 % of the time of " + bus.interface + ", found " +
                               format_number(std::round(1000 * bus.share) / 10) +
                               " % at worst for " + std::to_string(bus.axes) +
                               (bus.axes == 1 ? " axis at " : " axes at ") +
                               format_number(1 / compilation.spec.period_s) + " Hz; " +
                               std::to_string(bus.axes_that_fit) + " of these axes fit: use more " +
                               "interfaces, a higher bit rate, or a lower loop.rate_Hz");
}

/// How long the loop may wait for the answers of a tick.
double answers_s(Compilation& compilation, const DevicePlace& place,
                 const can::DeviceOptions& device) {
  constexpr double kMost = 0.8;  // of the period: the rest is for the commands
  if (device.timing != Timing::in_phase) return 0;
  const double answers_s = can::worst_answer_s(device, can::worst_of(device, compilation.buses));
  const double most_s = kMost * device.period_s;
  if (answers_s <= most_s) return answers_s;
  const Timing own = own_timing(device.protocol);
  compilation.refuse(place.path + ".can.timing",
                     "in phase, all answers must have come after 80 % of a period, " +
                         format_number(most_s) + " s; at worst they take " + up_to_us(answers_s) +
                         ": use more interfaces, or lower loop.rate_Hz" +
                         (own == Timing::in_phase ? "" : ", or " + word_of_timing(own)));
  return most_s;
}

void check_times(Compilation& compilation, const DevicePlace& place, can::DeviceOptions& device) {
  const can::BusLoad bus = can::worst_of(device, compilation.buses);
  device.collect_s = any_in_phase(compilation.can) ? compilation.collect_s : 0;
  if (device.timing == Timing::reply_to_command &&
      can::worst_reply_s(device, bus) > device.period_s)
    compilation.refuse(
        place.path + ".can.timing",
        "answers to the commands of a tick must have come when the next one begins; at "
        "worst they take " +
            up_to_us(can::worst_reply_s(device, bus)) +
            (device.collect_s > 0 ? ", since the loop waits for devices in phase first" : "") +
            ": use more interfaces, a lower loop.rate_Hz, or in_phase");
  device.worst_sample_age_s = can::worst_sample_age_s(device, bus);
  const double latency_s = can::worst_latency_s(device, bus);
  if (place.device.latency_s >= latency_s) return;
  compilation.refuse(place.path + ".latency_s",
                     "expected at least " + up_to_us(latency_s) + ": at worst a sample is " +
                         up_to_us(device.worst_sample_age_s) + " old (" +
                         word_of_timing(device.timing) +
                         "); the frames of the command, can.drive_delay_s and 50 us for the loop "
                         "come on top; found " +
                         format_number(place.device.latency_s) + " s");
}

}  // namespace

bool any_in_phase(const std::vector<std::optional<can::DeviceOptions>>& devices) {
  return std::ranges::any_of(
      devices, [](const auto& device) { return device && device->timing == Timing::in_phase; });
}

void compile_buses(Compilation& compilation, const std::vector<DevicePlace>& places) {
  for (const DevicePlace& place : places) {
    compilation.can.push_back(compile_drives(compilation, place));
  }
  std::vector<can::DeviceOptions> devices;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (!compilation.can[i]) continue;
    for (std::size_t j = 0; j <= i; ++j)
      if (compilation.can[j]) check_neighbours(compilation, j, i);
    devices.push_back(*compilation.can[i]);
  }
  compilation.buses = can::bus_loads(devices);
  for (const can::BusLoad& bus : compilation.buses) {
    const auto uses = [&](const DevicePlace& place) {
      const auto& device = compilation.can[place.index];
      return device && std::ranges::find(device->drives, bus.interface,
                                         &can::DriveOptions::interface) != device->drives.end();
    };
    const auto last = std::find_if(places.rbegin(), places.rend(), uses);
    check_load(compilation, bus, last->path + ".can.interface");
  }
  compilation.collect_s = compilation.spec.period_s / 2;
  for (const DevicePlace& place : places) {
    const auto& device = compilation.can[place.index];
    if (device)
      compilation.collect_s =
          std::max(compilation.collect_s, answers_s(compilation, place, *device));
  }
  for (const DevicePlace& place : places)
    if (compilation.can[place.index])
      check_times(compilation, place, *compilation.can[place.index]);
}

}  // namespace hapticd::config
