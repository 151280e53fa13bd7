#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "daemon/file_descriptor.h"
#include "daemon/hapticctl_emulate_part.h"
#include "sim/can/bus_socket.h"
#include "sim/can/cia402_drive.h"
#include "sim/can/emulated_bus.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/odrive_drive.h"
#include "sim/emulated_device.h"

namespace hapticd::daemon {
namespace {

using sim::can::Drive;

/// The mechanics move in such steps.
constexpr double kCanStep_s = 250e-6;
constexpr std::array kCanFaults{"reset", "fail", "mute", "speak"};

struct CanWire {
  FileDescriptor socket;
  std::unique_ptr<sim::can::EmulatedBus> bus;
};

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

class EmulatedCan final : public EmulatedPart {
 public:
  explicit EmulatedCan(const EmulateOptions& options) : options_(options) {}

  Result<void> start(const config::Compiled& compiled, std::int64_t start_ns) override {
    start_ns_ = start_ns;
    for (std::size_t i = 0; i < compiled.can.size(); ++i) {
      if (!compiled.can[i]) continue;
      if (auto added = add_device(*compiled.can[i], compiled.simulated[i]); !added) return added;
    }
    return {};
  }

  std::vector<std::string> names() const override {
    std::vector<std::string> axes;
    for (const auto& [axis, drive] : drives_) axes.push_back(axis);
    return axes;
  }
  std::span<const char* const> fault_kinds() const override { return kCanFaults; }
  bool has_firmware(const std::string&) const override { return false; }

  void befall(const Fault& fault, std::int64_t now_ns) override {
    const auto found =
        std::ranges::find(drives_, fault.name, [](const auto& d) { return d.first; });
    Drive& drive = *found->second;
    if (fault.kind == "reset") drive.reset(now_ns);
    if (fault.kind == "fail") drive.fail(fault_code(protocols_[&drive]), now_ns);
    if (fault.kind == "mute" || fault.kind == "speak") drive.mute(fault.kind == "mute");
  }

  Result<void> advance(std::int64_t now_ns) override {
    for (auto& device : devices_) device->advance(now_ns);
    for (auto& [name, wire] : wires_) wire.bus->advance(now_ns);
    return {};
  }

  std::int64_t next_ns(std::int64_t now_ns, std::vector<pollfd>& wait_on) const override {
    std::int64_t next_ns = wires_.empty() ? INT64_MAX : now_ns + std::llround(1e9 * kCanStep_s);
    for (const auto& [name, wire] : wires_) {
      next_ns = std::min(next_ns, wire.bus->next_ns());
      wait_on.push_back({.fd = wire.socket.get(), .events = POLLIN, .revents = 0});
    }
    return next_ns;
  }

  void add_to(Json& answer) const override {
    if (drives_.empty()) return;
    Json buses = Json::array();
    for (const auto& [name, wire] : wires_)
      buses.push_back({{"interface", name},
                       {"heard", wire.bus->received()},
                       {"said", wire.bus->sent()},
                       {"dropped", wire.bus->dropped()}});
    answer["drives"] = drives_.size();
    answer["buses"] = buses;
  }
  std::string text() const override {
    std::string text;
    for (const auto& [name, wire] : wires_)
      text += fmt::format("{}: heard {} frames, said {}, {} of them could not be sent\n", name,
                          wire.bus->received(), wire.bus->sent(), wire.bus->dropped());
    return text;
  }

 private:
  Result<void> add_device(const can::DeviceOptions& device, const sim::DeviceOptions& truth) {
    const auto elsewhere = [&](const can::DriveOptions& drive) {
      return !options_.bus.empty() && drive.interface != options_.bus;
    };
    if (std::ranges::any_of(device.drives, elsewhere)) return {};
    if (truth.axes.empty()) return nothing_to_move(device.name);
    std::vector<sim::EmulatedDevice::Joint> joints;
    for (std::size_t i = 0; i < device.drives.size(); ++i) {
      const can::DriveOptions& drive = device.drives[i];
      auto wire = wire_of(drive.interface, device.rates);
      if (!wire) return tl::unexpected(wire.error());
      owned_.push_back(make_drive(device, drive, options_, start_ns_));
      (*wire)->bus->add(*owned_.back());
      drives_.emplace_back(drive.axis, owned_.back().get());
      protocols_[owned_.back().get()] = device.protocol;
      const double turns_per_unit = drive.counts_per_unit / drive.counts_per_turn;
      joints.push_back(
          sim::turning(*owned_.back(), turns_per_unit, -turns_per_unit * truth.axes[i].zero_m));
    }
    devices_.push_back(std::make_unique<sim::EmulatedDevice>(truth, std::move(joints), kCanStep_s));
    return devices_.back()->start();
  }

  Result<CanWire*> wire_of(const std::string& interface, const can::BitRates& rates) {
    CanWire& wire = wires_[interface];
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

  const EmulateOptions& options_;
  std::int64_t start_ns_ = 0;
  std::map<std::string, CanWire> wires_;
  std::vector<std::unique_ptr<Drive>> owned_;
  std::vector<std::pair<std::string, Drive*>> drives_;  ///< by axis
  std::map<Drive*, can::Protocol> protocols_;
  std::vector<std::unique_ptr<sim::EmulatedDevice>> devices_;
};

}  // namespace

std::unique_ptr<EmulatedPart> emulated_can(const EmulateOptions& options) {
  return std::make_unique<EmulatedCan>(options);
}

}  // namespace hapticd::daemon
