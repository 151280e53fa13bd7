// Of `hapticctl emulate`: the emulated USB device that a config means.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include "control/core/result.h"
#include "drivers/usb/options.h"
#include "sim/emulated_device.h"
#include "sim/options.h"
#include "sim/usb/device.h"

namespace hapticd::sim::usb {
class Falcon;
}

namespace hapticd::daemon {

struct EmulatedUsbDevice {
  std::unique_ptr<sim::usb::Device> device{};
  sim::usb::Falcon* falcon = nullptr;  ///< where it is one
  std::vector<sim::EmulatedDevice::Joint> joints{};
  int interface = 0;               ///< HID
  std::uint8_t in_address = 0x81;  ///< of the endpoint that it speaks by
  bool own_supply = false;         ///< keeps its memory while it is unplugged
};

/// Errors: a firmware file that cannot be read; a layout that no emulated board has.
Result<EmulatedUsbDevice> emulate_usb(const usb::DeviceOptions& options,
                                      const sim::DeviceOptions& truth);

}  // namespace hapticd::daemon
