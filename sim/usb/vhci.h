// Linux' virtual USB host controller (module vhci-hcd): a device is plugged into it by handing the kernel one end of a
// stream, over which it then speaks USB/IP.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "control/core/result.h"
#include "sim/usb/device.h"

namespace hapticd::sim::usb {

/// Ports that are free and take devices of full and high speed, of the controller's file `status`. Lines that are none are
/// passed over.
std::vector<int> free_ports(std::string_view status);

class Vhci {
 public:
  struct Attached {
    int port = -1;
    int fd = -1;               ///< our end, non-blocking; the caller closes it, which unplugs
    std::uint32_t device = 0;  ///< the name that the kernel uses in its messages
  };

  explicit Vhci(std::string controller = "/sys/devices/platform/vhci_hcd.0")
      : controller_(std::move(controller)) {}

  /// Errors: no such controller (unavailable), no right (no_permission), no port is free (try_again).
  Result<Attached> attach(Speed speed) const;
  /// As if pulled out at the host. Nothing happens where nothing is attached.
  void detach(int port) const;

 private:
  std::string controller_;
};

}  // namespace hapticd::sim::usb
