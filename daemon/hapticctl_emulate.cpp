#include "daemon/hapticctl_emulate.h"

#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>

#include "config/compile.h"
#include "daemon/ctl_check.h"
#include "daemon/ctl_verbs.h"
#include "daemon/file_descriptor.h"
#include "daemon/interrupts.h"
#include "daemon/monotonic.h"
#include "daemon/realtime.h"
#include "sim/can/bus_socket.h"
#include "sim/can/cia402_drive.h"
#include "sim/can/emulated_bus.h"
#include "sim/can/emulated_device.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"

namespace hapticd::daemon {
namespace {

using sim::can::Drive;

/// The mechanics move in such steps.
constexpr double kStep_s = 250e-6;
constexpr std::array<const char*, 4> kKinds{"reset", "fail", "mute", "speak"};

/// What befalls a drive, and when.
struct Event {
  std::string kind{}, axis{};
  std::int64_t at_ns = 0;
  Drive* drive = nullptr;
};

struct Wire {
  FileDescriptor socket;
  std::unique_ptr<sim::can::EmulatedBus> bus;
};

Result<Event> event_of(const std::string& text) {
  const std::size_t colon = text.find(':'), at = text.rfind('@');
  Event event;
  double seconds = 0;
  const bool parts = colon != std::string::npos && at != std::string::npos && colon < at;
  if (parts) {
    event.kind = text.substr(0, colon);
    event.axis = text.substr(colon + 1, at - colon - 1);
  }
  const char* end = text.data() + text.size();
  const bool number = parts && std::from_chars(text.data() + at + 1, end, seconds).ptr == end &&
                      at + 1 < text.size();
  if (!number || !(seconds >= 0 && seconds < 1e9) ||
      std::ranges::find(kKinds, event.kind) == kKinds.end())
    return fail(ExitCode::usage,
                "--fault: expected KIND:AXIS@SECONDS, such as reset:left.x@2.5, "
                "with reset, fail, mute or speak; found " +
                    text);
  event.at_ns = std::llround(1e9 * seconds);
  return event;
}

/// A fault that each protocol has: over-temperature.
int fault_code(can::Protocol protocol) {
  switch (protocol) {
    case can::Protocol::odrive:
      return 1 << 13;
    case can::Protocol::moteus:
      return 38;
    case can::Protocol::cia402:
      return 0x4210;
  }
  return 0;
}

std::unique_ptr<Drive> make_drive(const can::DeviceOptions& device, const can::DriveOptions& drive,
                                  const EmulateOptions& options, std::int64_t now_ns) {
  const double drift = 1e-6 * options.drift_ppm;
  const double most_Nm =
      1.2 * drive.max_effort * drive.counts_per_turn / (2 * M_PI * std::abs(drive.counts_per_unit));
  switch (device.protocol) {
    case can::Protocol::odrive:
      return std::make_unique<sim::can::OdriveDrive>(
          sim::can::OdriveOptions{.node = drive.node,
                                  .max_torque_Nm = most_Nm,
                                  .watchdog_s = device.watchdog_s,
                                  .estimates_every_s = device.timing == drivers::Timing::in_phase
                                                           ? 0
                                                           : device.estimates_every_s,
                                  .heartbeat_every_s = device.heartbeat_every_s,
                                  .counts_per_turn = drive.counts_per_turn,
                                  .clock_drift = drift},
          now_ns);
    case can::Protocol::moteus:
      return std::make_unique<sim::can::MoteusDrive>(
          sim::can::MoteusOptions{.servo = drive.node,
                                  .prefix = device.prefix,
                                  .max_torque_Nm = most_Nm,
                                  .counts_per_turn = drive.counts_per_turn,
                                  .clock_drift = drift},
          now_ns);
    case can::Protocol::cia402:
      return std::make_unique<sim::can::Cia402Drive>(
          sim::can::Cia402Options{.node = drive.node,
                                  .rated_torque_Nm = std::max(0.001, most_Nm),
                                  .max_torque_Nm = most_Nm,
                                  .counts_per_rev = drive.counts_per_turn,
                                  .clock_drift = drift},
          now_ns);
  }
  return nullptr;
}

class Emulation {
 public:
  explicit Emulation(const EmulateOptions& options) : options_(options) {}

  Result<void> start(const config::Compiled& compiled) {
    start_ns_ = monotonic_ns();
    for (const std::string& text : options_.faults)
      if (auto event = event_of(text); !event) return tl::unexpected(event.error());
    for (std::size_t i = 0; i < compiled.can.size(); ++i) {
      if (!compiled.can[i]) continue;
      if (auto added = add_device(*compiled.can[i], compiled.simulated[i]); !added) return added;
    }
    if (devices_.empty())
      return fail(ExitCode::no,
                  options_.bus.empty()
                      ? "no device of this config has a driver for CAN"
                      : "no device of this config has all its drives on " + options_.bus);
    return add_events();
  }

  void run() {
    be_prompt();
    const std::atomic<bool>& interrupted = interrupts();
    const std::int64_t end_ns =
        options_.duration_s ? start_ns_ + std::llround(1e9 * *options_.duration_s) : INT64_MAX;
    for (std::int64_t now_ns = start_ns_; !interrupted && now_ns < end_ns;
         now_ns = monotonic_ns()) {
      befall(now_ns - start_ns_);
      for (auto& device : devices_) device->advance(now_ns);
      for (auto& [name, wire] : wires_) wire.bus->advance(now_ns);
      sleep(now_ns);
    }
  }

  Json json() const {
    Json buses = Json::array();
    for (const auto& [name, wire] : wires_)
      buses.push_back({{"interface", name},
                       {"heard", wire.bus->received()},
                       {"said", wire.bus->sent()},
                       {"dropped", wire.bus->dropped()}});
    return {{"ok", true}, {"drives", drives_.size()}, {"buses", buses}};
  }
  std::string text() const {
    std::string text;
    for (const auto& [name, wire] : wires_)
      text += fmt::format("{}: heard {} frames, said {}, {} of them could not be sent\n", name,
                          wire.bus->received(), wire.bus->sent(), wire.bus->dropped());
    return text;
  }
  std::string who() const {
    std::string text;
    for (const auto& [axis, drive] : drives_) text += (text.empty() ? "" : ", ") + axis;
    return text;
  }

 private:
  /// Drives answer within microseconds: no timer slack, and below the daemon's priority but above all else, where that is
  /// allowed.
  static void be_prompt() {
    constexpr int kPriority = 20;
    RealtimeReport rights;
    enter_realtime(kPriority, {}, rights);
    (void)::prctl(PR_SET_TIMERSLACK, 1UL);
  }

  Result<void> add_device(const can::DeviceOptions& device, const sim::DeviceOptions& truth) {
    const auto elsewhere = [&](const can::DriveOptions& drive) {
      return !options_.bus.empty() && drive.interface != options_.bus;
    };
    if (std::ranges::any_of(device.drives, elsewhere)) return {};
    if (truth.axes.empty())
      return fail(ExitCode::bad_data, "device " + device.name +
                                          ": nothing is known of what its motors move: give each "
                                          "axis a model, or the device a sim section");
    std::vector<sim::can::EmulatedDevice::Motor> motors;
    for (std::size_t i = 0; i < device.drives.size(); ++i) {
      const can::DriveOptions& drive = device.drives[i];
      auto wire = wire_of(drive.interface, device.rates);
      if (!wire) return tl::unexpected(wire.error());
      owned_.push_back(make_drive(device, drive, options_, start_ns_));
      (*wire)->bus->add(*owned_.back());
      drives_.emplace_back(drive.axis, owned_.back().get());
      protocols_[owned_.back().get()] = device.protocol;
      const double turns_per_unit = drive.counts_per_unit / drive.counts_per_turn;
      motors.push_back({.drive = owned_.back().get(),
                        .turns_per_unit = turns_per_unit,
                        .offset_turns = -turns_per_unit * truth.axes[i].zero_m});
    }
    devices_.push_back(
        std::make_unique<sim::can::EmulatedDevice>(truth, std::move(motors), kStep_s));
    return devices_.back()->start();
  }

  Result<Wire*> wire_of(const std::string& interface, const can::BitRates& rates) {
    Wire& wire = wires_[interface];
    if (wire.bus) return &wire;
    // Real drives with these ids would be driven on made-up positions.
    if (!options_.real && std::filesystem::exists("/sys/class/net/" + interface + "/device"))
      return fail(ExitCode::no, interface +
                                    " is a real controller: emulated drives on a bus with "
                                    "real ones are dangerous; --real if there are none");
    auto socket = sim::can::open_bus(interface);
    if (!socket) return tl::unexpected(socket.error());
    wire.socket = FileDescriptor(*socket);
    wire.bus = std::make_unique<sim::can::EmulatedBus>(
        *socket, sim::can::WireOptions{.nominal_Hz = rates.nominal_Hz,
                                       .data_Hz = rates.data_Hz,
                                       .loss = options_.loss,
                                       .duplicate = options_.duplicate,
                                       .delay_s = options_.delay_s,
                                       .jitter_s = options_.jitter_s});
    return &wire;
  }

  Result<void> add_events() {
    for (const std::string& text : options_.faults) {
      auto event = event_of(text);
      if (!event) return tl::unexpected(event.error());
      const auto found =
          std::ranges::find(drives_, event->axis, [](const auto& d) { return d.first; });
      if (found == drives_.end())
        return fail(ExitCode::usage,
                    "--fault: there is no axis " + event->axis + "; there are: " + who());
      event->drive = found->second;
      events_.push_back(*event);
    }
    std::ranges::sort(events_, {}, &Event::at_ns);
    return {};
  }

  void befall(std::int64_t time_ns) {
    while (next_event_ < events_.size() && events_[next_event_].at_ns <= time_ns) {
      const Event& event = events_[next_event_++];
      if (event.kind == "reset") event.drive->reset(start_ns_ + time_ns);
      if (event.kind == "fail")
        event.drive->fail(fault_code(protocols_[event.drive]), start_ns_ + time_ns);
      if (event.kind == "mute" || event.kind == "speak") event.drive->mute(event.kind == "mute");
      std::fprintf(stderr, "%s %s at %.3f s\n", event.kind.c_str(), event.axis.c_str(),
                   1e-9 * static_cast<double>(time_ns));
    }
  }

  /// Until a bus has something, or the next step of a drive or of the mechanics.
  void sleep(std::int64_t now_ns) {
    std::int64_t next_ns = now_ns + std::llround(1e9 * kStep_s);
    std::vector<pollfd> fds;
    for (const auto& [name, wire] : wires_) {
      next_ns = std::min(next_ns, wire.bus->next_ns());
      fds.push_back({.fd = wire.socket.get(), .events = POLLIN, .revents = 0});
    }
    const std::int64_t left_ns = std::max<std::int64_t>(0, next_ns - monotonic_ns());
    const timespec timeout{.tv_sec = 0, .tv_nsec = static_cast<long>(left_ns)};
    (void)::ppoll(fds.data(), fds.size(), &timeout, nullptr);
  }

  const EmulateOptions& options_;
  std::int64_t start_ns_ = 0;
  std::map<std::string, Wire> wires_;
  std::vector<std::unique_ptr<Drive>> owned_;
  std::vector<std::pair<std::string, Drive*>> drives_;  ///< by axis
  std::map<Drive*, can::Protocol> protocols_;
  std::vector<std::unique_ptr<sim::can::EmulatedDevice>> devices_;
  std::vector<Event> events_;
  std::size_t next_event_ = 0;
};

}  // namespace

ExitCode run_emulate(const EmulateOptions& options, bool json) {
  const auto compiled = config::load(options.config);
  if (!compiled) return print_config_errors(compiled.error(), json);
  Emulation emulation(options);
  if (auto started = emulation.start(*compiled); !started)
    return print_error(started.error(), json);
  std::fprintf(stderr, "emulating the drives of %s; end with Ctrl-C\n", emulation.who().c_str());
  emulation.run();
  std::fputs(json ? (to_text(emulation.json()) + "\n").c_str() : emulation.text().c_str(), stdout);
  return ExitCode::ok;
}

}  // namespace hapticd::daemon
