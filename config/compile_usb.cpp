// Devices on USB: what their drivers are told, what they lack, and the latency that their times add up to.
#include "config/compile_usb.h"

#include <algorithm>
#include <cmath>

#include "config/compile_drives.h"
#include "config/describe.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

constexpr double kInterval_s = 1e-3;  // between two samples, at full speed
constexpr double kLoop_s = 50e-6;     // from collect to command, as for devices on CAN
constexpr double kRounding = 1e-9;

std::optional<usb::Kind> kind_of(Driver driver) {
  switch (driver) {
    case Driver::falcon:
      return usb::Kind::falcon;
    case Driver::hid_report:
      return usb::Kind::hid_report;
    case Driver::openffboard:
      return usb::Kind::openffboard;
    case Driver::sim:
    case Driver::odrive:
    case Driver::moteus:
    case Driver::cia402:
      break;
  }
  return {};
}

std::string time_text(double seconds) {
  return format_number(std::round(1e7 * seconds) / 1e7) + " s";
}

enum class Wanted { no, maybe, yes };

/// The keys of a kind stand with its driver, and only there.
bool has_keys(Compilation& compilation, const DevicePlace& place, std::optional<usb::Kind> kind) {
  const std::string driver(word_of(place.device.driver));
  const auto check = [&](const char* key, bool found, Wanted wanted) {
    if (wanted == Wanted::maybe || found == (wanted == Wanted::yes)) return true;
    compilation.refuse(place.path + "." + key,
                       wanted == Wanted::yes ? "missing; expected here with driver: " + driver
                                             : "not with driver: " + driver + "; remove this key");
    return false;
  };
  const auto only = [&](usb::Kind of, Wanted wanted) { return kind == of ? wanted : Wanted::no; };
  const Device& device = place.device;
  const Wanted usb = kind == usb::Kind::hid_report ? Wanted::yes : Wanted::maybe;
  bool good = check("usb", device.usb.has_value(), kind ? usb : Wanted::no);
  good &= check("falcon", device.falcon.has_value(), only(usb::Kind::falcon, Wanted::maybe));
  good &= check("report", device.report.has_value(), only(usb::Kind::hid_report, Wanted::yes));
  good &= check("openffboard", device.openffboard.has_value(),
                only(usb::Kind::openffboard, Wanted::yes));
  return good;
}

double send_s(const UsbPlace& place) {
  const bool board = place.kind == usb::Kind::openffboard;
  const double axes = static_cast<double>(place.device.device.axes.size());
  return place.keys.send_s.value_or(2e-3 + (board ? 1e-3 * axes : 0));
}

double arrival_age_s(const UsbPlace& place) {
  return place.keys.arrival_age_s.value_or(place.kind == usb::Kind::openffboard ? 3e-3 : 1e-3);
}

/// By hidapi a report is found only once the one that goes out has gone, a frame later.
double max_age_s(const UsbPlace& place) {
  const bool waits =
      place.kind == usb::Kind::hid_report && usb_transport(place) == usb::Transport::hidapi;
  const double usual_s = waits ? 3.5e-3 : 2.5e-3;
  return place.keys.max_age_s.value_or(place.kind == usb::Kind::openffboard ? 8e-3 : usual_s);
}

double silence_s(const UsbPlace& place) {
  return place.keys.silence_s.value_or(place.kind == usb::Kind::openffboard ? 0.15 : 0.1);
}

void check_ages(const UsbPlace& place) {
  const double least_s = arrival_age_s(place) + kInterval_s;
  if (max_age_s(place) < least_s - kRounding)
    place.refuse("usb.max_age_s",
                 "expected at least " + time_text(least_s) +
                     ", or sound samples are missing: they are up to usb.arrival_age_s old when "
                     "they arrive, and the next one comes 1 ms later; found " +
                     time_text(max_age_s(place)));
  constexpr double kLeastSilence_s = 0.12;
  if (place.kind == usb::Kind::openffboard && silence_s(place) < kLeastSilence_s)
    place.refuse("usb.silence_s",
                 "expected at least 0.12 s: an OpenFFBoard that does not move says so only every "
                 "0.1 s; found " +
                     time_text(silence_s(place)));
  else if (silence_s(place) <= max_age_s(place))
    place.refuse("usb.silence_s", "expected more than usb.max_age_s, " +
                                      time_text(max_age_s(place)) + ", found " +
                                      time_text(silence_s(place)));
}

void check_watchdog(const UsbPlace& place) {
  const double least_s = 3 * place.compilation.spec.period_s;
  if (place.keys.watchdog_s >= least_s - kRounding) return;
  place.refuse("usb.watchdog_s", "expected at least 3 ticks, " + time_text(least_s) +
                                     ", or a tick that comes late takes the force away; found " +
                                     time_text(place.keys.watchdog_s));
}

/// Digital inputs that the device has.
void check_inputs(const UsbPlace& place) {
  const Device& device = place.device.device;
  constexpr std::size_t kFalconButtons = 4, kAll = 32;
  const std::size_t count = place.kind == usb::Kind::falcon       ? kFalconButtons
                            : place.kind == usb::Kind::hid_report ? device.report->in.buttons.size()
                                                                  : kAll;
  for (std::size_t i = 0; i < device.enable_inputs.size(); ++i) {
    const auto bit = static_cast<std::size_t>(device.enable_inputs[i].bit);
    if (bit < count) continue;
    place.refuse(
        indexed("enable_inputs", i) + ".bit",
        (count == 0 ? "report.in.buttons names no input"
                    : "expected 0 to " + std::to_string(count - 1) + ", as this device has " +
                          std::to_string(count) + (count == 1 ? " input" : " inputs")) +
            ", found " + std::to_string(bit));
  }
}

void check_force_sensor(const UsbPlace& place) {
  const Device& device = place.device.device;
  if (!device.force_sensor) return;
  const std::size_t wanted = device.force_sensor->directions.size();
  const std::size_t count =
      place.kind == usb::Kind::hid_report ? device.report->in.analogue.size() : 0;
  if (wanted <= count) return;
  place.refuse("force_sensor.directions",
               place.kind == usb::Kind::hid_report
                   ? "expected one channel of report.in.analogue for each, found " +
                         std::to_string(wanted) + " directions and " + std::to_string(count) +
                         (count == 1 ? " channel" : " channels")
                   : "driver: " + place.driver() + " has no force sensor; remove it");
}

/// Of a zero or an index nothing but a Falcon's reports tell.
void check_homing(const UsbPlace& place) {
  const auto& axes = place.device.device.axes;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const HomingMethod by = axes[i].homing.by;
    const bool unknown = by == HomingMethod::index ||
                         (by == HomingMethod::device && place.kind != usb::Kind::falcon);
    if (!unknown) continue;
    place.refuse_axis(i, "homing.by",
                      "driver: " + place.driver() + " is told of no " +
                          (by == HomingMethod::index ? "index" : "zero") +
                          ", so this would never end; found " + std::string(word_of(by)));
  }
}

std::vector<usb::AxisOptions> axes_of(const DevicePlace& place) {
  std::vector<usb::AxisOptions> axes;
  for (std::size_t i = 0; i < place.axes.size(); ++i) {
    const Axis& axis = place.device.axes[i];
    const double counts = place.axes[i].counts_per_unit;
    axes.push_back({.name = place.device.name + "." + axis.name,
                    .counts_per_unit = axis.encoder.reversed ? -counts : counts,
                    .max_effort = place.axes[i].max_effort});
  }
  return axes;
}

usb::DeviceOptions options_of(const UsbPlace& place) {
  constexpr int kBelowLoop = 10;
  check_ages(place);
  check_watchdog(place);
  check_inputs(place);
  check_force_sensor(place);
  check_homing(place);
  usb::DeviceOptions options;
  options.name = place.device.device.name;
  options.kind = place.kind;
  options.selection = compile_selection(place);
  options.period_s = place.compilation.spec.period_s;
  options.arrival_age_s = arrival_age_s(place);
  options.worst_sample_age_s = max_age_s(place);
  options.send_s = send_s(place);
  options.drive_delay_s = place.keys.drive_delay_s;
  options.watchdog_s = place.keys.watchdog_s;
  options.silence_s = silence_s(place);
  options.priority = std::max(1, place.compilation.config.loop.priority - kBelowLoop);
  options.axes = axes_of(place.device);
  if (place.kind == usb::Kind::falcon) options.falcon = compile_falcon(place);
  if (place.kind == usb::Kind::hid_report) options.report = compile_report(place);
  if (place.kind == usb::Kind::openffboard) options.openffboard = compile_openffboard(place);
  return options;
}

std::optional<usb::DeviceOptions> compile_one(Compilation& compilation, const DevicePlace& place) {
  const auto kind = kind_of(place.device.driver);
  if (!has_keys(compilation, place, kind) || !kind) return {};
  const UsbDevice keys = place.device.usb.value_or(UsbDevice{});
  return options_of({compilation, place, keys, *kind});
}

void check_latency(Compilation& compilation, const DevicePlace& place,
                   const usb::DeviceOptions& device) {
  const double waits_s = any_in_phase(compilation.can) ? compilation.collect_s : 0;
  const double least_s = least_latency_s(device, waits_s);
  if (place.device.latency_s >= least_s - kRounding) return;
  compilation.refuse(
      place.path + ".latency_s",
      "expected at least " + time_text(least_s) + ": at worst a sample is " +
          time_text(device.worst_sample_age_s) + " old (usb.max_age_s); usb.send_s " +
          time_text(device.send_s) + ", usb.drive_delay_s " + time_text(device.drive_delay_s) +
          " and 50 us for the loop" +
          (waits_s > 0 ? ", which waits for devices in phase for " + time_text(waits_s) + " before,"
                       : "") +
          " come on top; found " + format_number(place.device.latency_s) + " s");
}

}  // namespace

std::string UsbPlace::driver() const {
  return std::string(word_of(device.device.driver));
}

void check_effort(const UsbPlace& place, std::size_t axis, double most, const std::string& by) {
  const AxisValues& values = place.device.axes[axis];
  if (!(values.max_effort > most * (1 + kRounding))) return;
  place.refuse_axis(axis, values.rotary ? "actuator.max_torque_Nm" : "actuator.max_force_N",
                    "expected at most " + format_number(most) + " " + effort_unit(values.rotary) +
                        ", which is what " + by + " carries, found " +
                        format_number(values.max_effort));
}

double least_latency_s(const usb::DeviceOptions& device, double waits_s) {
  return device.worst_sample_age_s + device.send_s + device.drive_delay_s + kLoop_s + waits_s;
}

double waits_s(const Compiled& compiled) {
  return any_in_phase(compiled.can) ? compiled.collect_s : 0;
}

void compile_usb(Compilation& compilation, const std::vector<DevicePlace>& places) {
  for (const DevicePlace& place : places)
    compilation.usb.push_back(compile_one(compilation, place));
  for (const DevicePlace& place : places) {
    if (!compilation.usb[place.index]) continue;
    check_latency(compilation, place, *compilation.usb[place.index]);
    check_selection(compilation, place.index);
  }
}

}  // namespace hapticd::config
