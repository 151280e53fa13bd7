#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

#include "daemon/hapticctl_emulate_part.h"
#include "daemon/hapticctl_emulate_usb_kinds.h"
#include "daemon/hapticctl_emulate_usb_plug.h"
#include "sim/usb/falcon.h"

namespace hapticd::daemon {
namespace {

/// The mechanics move in such steps: a frame, in which a torque comes once.
constexpr double kUsbStep_s = 1e-3;
constexpr std::array kUsbFaults{"unplug", "plug",  "reset", "hang",
                                "mute",   "speak", "stall", "mark"};
constexpr std::int64_t kHang_ns = 200'000'000;

/// What the motors did from one thing that befell the device to the next: shows a force where there must be none.
struct Phase {
  std::string since{};
  std::int64_t at_ns = 0;                      ///< CLOCK_MONOTONIC
  double largest_torque = 0, last_torque = 0;  ///< of any motor, in its unit
};

/// One device with all that moves it.
class UsbStandIn {
 public:
  UsbStandIn(const usb::DeviceOptions& options, EmulatedUsbDevice made,
             const sim::usb::WireOptions& wire, std::int64_t start_ns)
      : name_(options.name),
        made_(std::move(made)),
        wire_(*made_.device, wire),
        start_ns_(start_ns) {
    begin("start", start_ns);
  }

  Result<void> start(const sim::DeviceOptions& truth, bool uhid) {
    mechanics_ = std::make_unique<sim::EmulatedDevice>(truth, made_.joints, kUsbStep_s);
    if (auto started = mechanics_->start(); !started) return started;
    if (!uhid) {
      plug_ = plug_by_usbip(wire_);
      return {};
    }
    if (made_.falcon != nullptr)
      return fail(ExitCode::usage, "--uhid: " + name_ + " is no HID device");
    auto plug = plug_by_uhid(wire_, made_.interface);
    if (!plug) return tl::unexpected(plug.error());
    plug_ = std::move(*plug);
    return {};
  }

  const std::string& name() const { return name_; }
  bool has_firmware() const { return made_.falcon != nullptr; }

  void befall(const Fault& fault, std::int64_t now_ns) {
    if (fault.percent) {
      awaited_.push_back(fault);
      return;
    }
    begin(fault.kind, now_ns);
    if (fault.kind == "unplug") wire_.unplug();
    if (fault.kind == "plug") wire_.plug(!made_.own_supply, now_ns);
    if (fault.kind == "hang") wire_.hang(now_ns + kHang_ns);
    if (fault.kind == "mute") wire_.hang(sim::usb::kNever);
    if (fault.kind == "speak") wire_.hang(now_ns);
    if (fault.kind == "stall") wire_.stall(made_.in_address);
    if (fault.kind == "reset") {
      wire_.unplug();
      resets_ = true;
    }
  }

  Result<void> advance(std::int64_t now_ns) {
    mechanics_->advance(now_ns);
    if (auto advanced = plug_->advance(now_ns); !advanced) return advanced;
    if (std::string why = plug_->take_trouble(); !why.empty()) {
      std::fprintf(stderr, "%s: %s\n", name_.c_str(), why.c_str());
      begin("detach", now_ns);
    }
    if (std::exchange(resets_, false)) wire_.plug(true, now_ns);
    look_at_motors();
    look_at_firmware(now_ns);
    return {};
  }

  std::int64_t next_ns(std::vector<pollfd>& wait_on) const {
    plug_->add_to(wait_on);
    return plug_->next_ns();
  }

  Json json() const {
    Json phases = Json::array();
    for (const Phase& phase : phases_)
      phases.push_back({{"since", phase.since},
                        {"at_s", since_start_s(phase.at_ns)},
                        {"time_ns", phase.at_ns},
                        {"largest_torque", phase.largest_torque},
                        {"last_torque", phase.last_torque}});
    return {{"name", name_},
            {"transfers", wire_.carried()},
            {"befallen", wire_.befallen()},
            {"phases", phases}};
  }
  std::string text() const {
    std::string text = fmt::format("{}: {} transfers, {} of them dropped, doubled or cut\n", name_,
                                   wire_.carried(), wire_.befallen());
    for (const Phase& phase : phases_)
      text += fmt::format("  from {} at {:.3f} s: largest torque {:.6g}, at the end {:.6g}\n",
                          phase.since, since_start_s(phase.at_ns), phase.largest_torque,
                          phase.last_torque);
    return text;
  }

 private:
  void begin(const std::string& since, std::int64_t now_ns) {
    phases_.push_back({.since = since, .at_ns = now_ns});
  }
  double since_start_s(std::int64_t at_ns) const {
    return 1e-9 * static_cast<double>(at_ns - start_ns_);
  }

  void look_at_motors() {
    Phase& phase = phases_.back();
    phase.last_torque = 0;
    for (std::size_t i = 0; i < made_.device->motors(); ++i)
      phase.last_torque = std::max(phase.last_torque, std::abs(made_.device->motor(i).torque()));
    phase.largest_torque = std::max(phase.largest_torque, phase.last_torque);
  }

  void look_at_firmware(std::int64_t now_ns) {
    if (awaited_.empty()) return;
    const auto loaded = made_.falcon->board().loaded_share();
    if (!loaded || 100 * *loaded < *awaited_.front().percent) return;
    Fault fault = awaited_.front();
    awaited_.erase(awaited_.begin());
    std::fprintf(stderr, "%s %s with %.1f %% of its firmware at %.3f s\n", fault.kind.c_str(),
                 name_.c_str(), 100 * *loaded, since_start_s(now_ns));
    fault.percent.reset();
    befall(fault, now_ns);
  }

  std::string name_;
  EmulatedUsbDevice made_;
  sim::usb::Wire wire_;
  std::unique_ptr<sim::EmulatedDevice> mechanics_;
  std::unique_ptr<UsbPlug> plug_;
  std::vector<Phase> phases_;
  std::vector<Fault> awaited_;  ///< for a share of the firmware
  std::int64_t start_ns_;
  bool resets_ = false;
};

class EmulatedUsb final : public EmulatedPart {
 public:
  explicit EmulatedUsb(const EmulateOptions& options) : options_(options) {}

  Result<void> start(const config::Compiled& compiled, std::int64_t start_ns) override {
    start_ns_ = start_ns;
    if (!options_.bus.empty()) return {};
    for (std::size_t i = 0; i < compiled.usb.size(); ++i) {
      if (!compiled.usb[i]) continue;
      if (auto added = add_device(*compiled.usb[i], compiled.simulated[i]); !added) return added;
    }
    return {};
  }

  std::vector<std::string> names() const override {
    std::vector<std::string> all;
    for (const auto& device : devices_) all.push_back(device->name());
    return all;
  }
  std::span<const char* const> fault_kinds() const override { return kUsbFaults; }
  bool has_firmware(const std::string& name) const override { return find(name).has_firmware(); }
  void befall(const Fault& fault, std::int64_t now_ns) override {
    find(fault.name).befall(fault, now_ns);
  }
  Result<void> advance(std::int64_t now_ns) override {
    for (const auto& device : devices_)
      if (auto advanced = device->advance(now_ns); !advanced) return advanced;
    return {};
  }
  std::int64_t next_ns(std::int64_t now_ns, std::vector<pollfd>& wait_on) const override {
    std::int64_t next_ns = devices_.empty() ? INT64_MAX : now_ns + std::llround(1e9 * kUsbStep_s);
    for (const auto& device : devices_) next_ns = std::min(next_ns, device->next_ns(wait_on));
    return next_ns;
  }
  void add_to(Json& answer) const override {
    if (devices_.empty()) return;
    answer["usb"] = Json::array();
    for (const auto& device : devices_) answer["usb"].push_back(device->json());
  }
  std::string text() const override {
    std::string text;
    for (const auto& device : devices_) text += device->text();
    return text;
  }

 private:
  UsbStandIn& find(const std::string& name) const {
    return **std::ranges::find(devices_, name, [](const auto& device) { return device->name(); });
  }

  Result<void> add_device(const usb::DeviceOptions& device, const sim::DeviceOptions& truth) {
    if (truth.axes.empty()) return nothing_to_move(device.name);
    auto made = emulate_usb(device, truth);
    if (!made) return tl::unexpected(made.error());
    devices_.push_back(
        std::make_unique<UsbStandIn>(device, std::move(*made),
                                     sim::usb::WireOptions{.jitter_s = options_.jitter_s,
                                                           .drop = options_.loss,
                                                           .duplicate = options_.duplicate,
                                                           .runt = options_.runt,
                                                           .seed = devices_.size() + 1},
                                     start_ns_));
    return devices_.back()->start(truth, options_.uhid);
  }

  const EmulateOptions& options_;
  std::int64_t start_ns_ = 0;
  std::vector<std::unique_ptr<UsbStandIn>> devices_;
};

}  // namespace

std::unique_ptr<EmulatedPart> emulated_usb(const EmulateOptions& options) {
  return std::make_unique<EmulatedUsb>(options);
}

}  // namespace hapticd::daemon
