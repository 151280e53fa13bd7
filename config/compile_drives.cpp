// Devices of CAN drives: what their drivers are told.
#include "config/compile_drives.h"

#include <algorithm>
#include <cmath>

#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

using drivers::Timing;

constexpr double kLongestWatchdog_s = 0.05;
constexpr double kVelocityReserve = 2;  // near its own limit an ODrive weakens the torque

std::optional<can::Protocol> protocol_of(Driver driver) {
  switch (driver) {
    case Driver::sim:
    case Driver::falcon:
    case Driver::hid_report:
    case Driver::openffboard:
      return {};
    case Driver::odrive:
      return can::Protocol::odrive;
    case Driver::moteus:
      return can::Protocol::moteus;
    case Driver::cia402:
      return can::Protocol::cia402;
  }
  return {};
}

struct Nodes {
  int min = 0, max = 0;
};
Nodes nodes_of(can::Protocol protocol) {
  switch (protocol) {
    case can::Protocol::odrive:
      return {0, 62};
    case can::Protocol::moteus:
      return {1, 126};
    case can::Protocol::cia402:
      return {1, 127};
  }
  return {};
}

/// One device of CAN drives.
struct CanPlace {
  Compilation& compilation;
  const DevicePlace& device;
  const CanBus& bus;
  can::Protocol protocol;

  std::string path(const char* key) const { return device.path + ".can." + key; }
  std::string drive_path(std::size_t axis, const char* key) const {
    return device.axes[axis].path + ".can." + key;
  }
};

Timing timing_of(const CanPlace& place) {
  const Timing own = own_timing(place.protocol);
  if (!place.bus.timing) return own;
  const auto asked = static_cast<Timing>(*place.bus.timing);
  if (asked == own || asked == Timing::in_phase) return asked;
  place.compilation.refuse(
      place.path("timing"),
      "expected " + word_of_timing(own) +
          (own == Timing::in_phase ? "" : " or " + word_of_timing(Timing::in_phase)) +
          " for driver: " + std::string(word_of(place.device.device.driver)) + ", found " +
          word_of_timing(asked));
  return own;
}

/// Faults come first, then the drive's own watchdog, and that within what a hand may take.
void check_watchdog(const CanPlace& place) {
  const double period_s = place.compilation.spec.period_s;
  const int ticks = place.device.guard.max_stale_ticks + 1;
  if (place.bus.watchdog_s > ticks * period_s) return;
  place.compilation.refuse(
      place.path("watchdog_s"),
      "expected more than " + std::to_string(ticks) + " ticks, " + format_number(ticks * period_s) +
          " s: hapticd gives up after that many without a sample, and the drive must not be first; "
          "found " +
          format_number(place.bus.watchdog_s) + " s, which needs loop.rate_Hz above " +
          format_number(ticks / place.bus.watchdog_s) + " (the longest watchdog, " +
          format_number(kLongestWatchdog_s) + " s, needs " +
          format_number(ticks / kLongestWatchdog_s) + ")");
}

can::DriveOptions drive_of(const CanPlace& place, std::size_t i) {
  const Axis& axis = place.device.device.axes[i];
  const AxisValues& values = place.device.axes[i];
  const CanDrive& drive = *axis.can;
  const double turns_per_unit = values.counts_per_unit / drive.counts_per_turn;
  const Nodes nodes = nodes_of(place.protocol);
  if (drive.node < nodes.min || drive.node > nodes.max) {
    place.compilation.refuse(
        place.drive_path(i, "node"),
        "expected " + std::to_string(nodes.min) + " to " + std::to_string(nodes.max) +
            " for driver: " + std::string(word_of(place.device.device.driver)) + ", found " +
            std::to_string(drive.node));
  }
  return {
      .axis = place.device.device.name + "." + axis.name,
      .interface = drive.interface.value_or(place.bus.interface),
      .node = static_cast<std::uint8_t>(drive.node),
      .counts_per_unit = axis.encoder.reversed ? -values.counts_per_unit : values.counts_per_unit,
      .counts_per_turn = drive.counts_per_turn,
      .max_effort = values.max_effort,
      .max_velocity_turns_s = drive.max_velocity_turns_s.value_or(
          kVelocityReserve * values.max_velocity * turns_per_unit),
      .max_current_A = drive.max_current_A.value_or(0)};
}

std::uint8_t host_node(const CanPlace& place) {
  constexpr std::uint8_t kUsual = 127;
  const auto id = static_cast<std::uint8_t>(place.bus.host_id);
  return place.protocol == can::Protocol::cia402 && id == 0 ? kUsual : id;
}

void check_host_id(const CanPlace& place) {
  if (place.protocol == can::Protocol::odrive) return;
  const std::uint8_t id = host_node(place);
  for (const Axis& axis : place.device.device.axes) {
    if (axis.can->node != id) continue;
    place.compilation.refuse(place.path("host_id"), "expected an id that no drive has, found " +
                                                        std::to_string(id) +
                                                        ", the node of axis '" + axis.name + "'");
  }
}

/// Keys of CAN where there is CAN, and only there.
bool has_keys(Compilation& compilation, const DevicePlace& place, bool wanted) {
  const std::string driver(word_of(place.device.driver));
  const auto check = [&](const std::string& path, bool found) {
    if (found == wanted) return true;
    compilation.refuse(path, wanted ? "missing; expected here with driver: " + driver
                                    : "driver: " + driver + " has no CAN bus; remove this key");
    return false;
  };
  bool good = check(place.path + ".can", place.device.can.has_value());
  for (std::size_t i = 0; i < place.axes.size(); ++i)
    good = check(place.axes[i].path + ".can", place.device.axes[i].can.has_value()) && good;
  return good;
}

/// A key that another driver has would be taken for granted and do nothing.
void refuse_foreign_keys(const CanPlace& place) {
  const CanBus usual;
  const auto refuse = [&](bool given, const std::string& path, const char* drivers) {
    if (!given) return;
    place.compilation.refuse(path,
                             std::string("a key of driver: ") + drivers + ", found with driver: " +
                                 std::string(word_of(place.device.device.driver)) + "; remove it");
  };
  const bool odrive = place.protocol == can::Protocol::odrive;
  const bool moteus = place.protocol == can::Protocol::moteus;
  const CanBus& bus = place.bus;
  refuse(!moteus && bus.prefix != usual.prefix, place.path("prefix"), "moteus");
  refuse(!moteus && bus.ignore_position_bounds, place.path("ignore_position_bounds"), "moteus");
  refuse(!moteus && bus.data_bitrate_Hz != usual.data_bitrate_Hz, place.path("data_bitrate_Hz"),
         "moteus");
  refuse(odrive && bus.host_id != usual.host_id, place.path("host_id"), "moteus or cia402");
  refuse(moteus && bus.heartbeat_every_s != usual.heartbeat_every_s,
         place.path("heartbeat_every_s"), "odrive or cia402");
  refuse(!odrive && bus.estimates_every_s != usual.estimates_every_s,
         place.path("estimates_every_s"), "odrive");
  for (std::size_t i = 0; i < place.device.axes.size(); ++i) {
    const CanDrive& drive = *place.device.device.axes[i].can;
    refuse(!odrive && drive.max_current_A, place.drive_path(i, "max_current_A"), "odrive");
    refuse(!odrive && drive.max_velocity_turns_s, place.drive_path(i, "max_velocity_turns_s"),
           "odrive");
    if (odrive && drive.max_velocity_turns_s && !drive.max_current_A)
      place.compilation.refuse(place.drive_path(i, "max_velocity_turns_s"),
                               "an ODrive is told both limits or none: give max_current_A, too");
  }
}

void check_interface(const CanPlace& place, const std::string& path, const std::string& name) {
  constexpr std::size_t kLongest = 15;  // of the kernel
  const bool good =
      !name.empty() && name.size() <= kLongest && name.find_first_of(" /:") == std::string::npos;
  if (!good)
    place.compilation.refuse(path,
                             "expected the name of an interface, 1 to 15 letters such as "
                             "can0, found '" +
                                 name + "'");
}

can::DeviceOptions options_of(const CanPlace& place) {
  can::DeviceOptions options{
      .name = place.device.device.name,
      .protocol = place.protocol,
      .timing = timing_of(place),
      .period_s = place.compilation.spec.period_s,
      .rates = {.nominal_Hz = place.bus.bitrate_Hz, .data_Hz = place.bus.data_bitrate_Hz},
      .turnaround_s = place.bus.turnaround_s,
      .drive_delay_s = place.bus.drive_delay_s,
      .watchdog_s = place.bus.watchdog_s,
      .most_unsent_ticks = place.device.guard.max_stale_ticks,
      .collect_s = 0,
      .worst_sample_age_s = 0,
      .drives = {},
      .estimates_every_s = place.bus.estimates_every_s,
      .heartbeat_every_s = place.bus.heartbeat_every_s,
      .source = host_node(place),
      .prefix = static_cast<std::uint16_t>(place.bus.prefix),
      .ignore_position_bounds = place.bus.ignore_position_bounds,
      .host_node = host_node(place)};
  refuse_foreign_keys(place);
  check_interface(place, place.path("interface"), place.bus.interface);
  check_watchdog(place);
  check_host_id(place);
  for (std::size_t i = 0; i < place.device.axes.size(); ++i)
    options.drives.push_back(drive_of(place, i));
  if (options.timing == Timing::free_running &&
      options.estimates_every_s > options.period_s * 1.0001) {
    place.compilation.refuse(place.path("estimates_every_s"),
                             "every tick needs a sample: expected at most the period, " +
                                 format_number(options.period_s) + " s, found " +
                                 format_number(options.estimates_every_s) +
                                 " s; an ODrive sends one a millisecond at most, so use "
                                 "timing: in_phase, or a loop.rate_Hz of at most 1000");
  }
  return options;
}

}  // namespace

Timing own_timing(can::Protocol protocol) {
  switch (protocol) {
    case can::Protocol::odrive:
      return Timing::free_running;
    case can::Protocol::moteus:
      return Timing::reply_to_command;
    case can::Protocol::cia402:
      return Timing::in_phase;
  }
  return Timing::in_phase;
}

std::string word_of_timing(Timing timing) {
  return std::string(word_of(static_cast<CanTiming>(timing)));
}

std::optional<can::DeviceOptions> compile_drives(Compilation& compilation,
                                                 const DevicePlace& place) {
  const auto protocol = protocol_of(place.device.driver);
  const bool good = has_keys(compilation, place, protocol.has_value());
  if (!protocol || !good) return {};
  return options_of({compilation, place, *place.device.can, *protocol});
}

}  // namespace hapticd::config
