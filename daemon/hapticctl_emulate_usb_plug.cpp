#include "daemon/hapticctl_emulate_usb_plug.h"

#include <sched.h>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <utility>

#include "sim/usb/vhci.h"

namespace hapticd::daemon {
namespace {

using sim::usb::Wire;

/// The kernel's threads of the virtual controller stand for the interrupts of a real one, which real-time kernels serve
/// before all but the loop and its devices. They are new each time that a device is plugged in. Where that is not allowed,
/// answers come late now and then.
void hasten_controller() {
  constexpr sched_param kPriority{.sched_priority = 50};
  std::error_code ended;  // a process may end while it is looked at
  for (const auto& process : std::filesystem::directory_iterator("/proc", ended)) {
    const std::string number = process.path().filename();
    pid_t id = 0;
    const char* end = number.data() + number.size();
    if (std::from_chars(number.data(), end, id).ptr != end) continue;
    std::string name;
    std::getline(std::ifstream(process.path() / "comm"), name);
    if (name == "vhci_rx" || name == "vhci_tx")
      (void)::sched_setscheduler(id, SCHED_FIFO, &kPriority);
  }
}

class UsbipPlug final : public UsbPlug {
 public:
  explicit UsbipPlug(Wire& wire) : wire_(wire) {}

  Result<void> advance(std::int64_t now_ns) override {
    if (wire_.plugged() && !server_) {
      auto attached = vhci_.attach(wire_.device().speed());
      if (!attached) return tl::unexpected(attached.error());
      server_.emplace(wire_, attached->fd, attached->device);
      hasten_controller();
    }
    if (!server_) {
      (void)wire_.advance(now_ns);
    } else if (!server_->advance(now_ns)) {
      if (wire_.plugged()) trouble_ = server_->over();
      server_.reset();
      if (wire_.plugged()) wire_.unplug();
    }
    return {};
  }
  std::int64_t next_ns() const override { return server_ ? server_->next_ns() : wire_.next_ns(); }
  void add_to(std::vector<pollfd>& wait_on) const override {
    if (!server_) return;
    const int events = POLLIN | (server_->wants_to_write() ? POLLOUT : 0);
    wait_on.push_back({.fd = server_->fd(), .events = static_cast<short>(events), .revents = 0});
  }

 private:
  Wire& wire_;
  sim::usb::Vhci vhci_;
  std::optional<sim::usb::UsbipServer> server_;
};

class UhidPlug final : public UsbPlug {
 public:
  UhidPlug(Wire& wire, int fd, int interface) : device_(wire, fd, interface) {}

  Result<void> advance(std::int64_t now_ns) override {
    if (device_.advance(now_ns)) return {};
    return fail(ExitCode::unavailable, "the kernel takes no more events of an emulated HID device");
  }
  std::int64_t next_ns() const override { return device_.next_ns(); }
  void add_to(std::vector<pollfd>& wait_on) const override {
    wait_on.push_back({.fd = device_.fd(), .events = POLLIN, .revents = 0});
  }

 private:
  sim::usb::UhidDevice device_;
};

}  // namespace

std::unique_ptr<UsbPlug> plug_by_usbip(Wire& wire) {
  return std::make_unique<UsbipPlug>(wire);
}

Result<std::unique_ptr<UsbPlug>> plug_by_uhid(Wire& wire, int interface) {
  auto fd = sim::usb::open_uhid();
  if (!fd) return tl::unexpected(fd.error());
  return std::make_unique<UhidPlug>(wire, *fd, interface);
}

}  // namespace hapticd::daemon
