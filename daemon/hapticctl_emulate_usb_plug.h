// Of `hapticctl emulate`: plugs an emulated USB device into this machine's kernel while its wire is plugged in.
#pragma once
#include <poll.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "control/core/result.h"
#include "sim/usb/uhid_device.h"
#include "sim/usb/usbip_server.h"
#include "sim/usb/wire.h"

namespace hapticd::daemon {

class UsbPlug {
 public:
  virtual ~UsbPlug() = default;
  /// Runs the wire up to now. An end by the host unplugs the wire. Errors: the kernel takes no device.
  virtual Result<void> advance(std::int64_t now_ns) = 0;
  virtual std::int64_t next_ns() const = 0;
  virtual void add_to(std::vector<pollfd>& wait_on) const = 0;
  /// Why the host let go of it; empty: it did not, or that was told.
  std::string take_trouble() { return std::exchange(trouble_, {}); }

 protected:
  std::string trouble_;
};

/// By a virtual host controller: all of the kernel's USB, root alone.
std::unique_ptr<UsbPlug> plug_by_usbip(sim::usb::Wire& wire);
/// By /dev/uhid: a HID interface alone.
Result<std::unique_ptr<UsbPlug>> plug_by_uhid(sim::usb::Wire& wire, int interface);

}  // namespace hapticd::daemon
