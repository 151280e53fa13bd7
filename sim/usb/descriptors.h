// Descriptors of a device and its configuration (USB 2.0, 9.6; HID 1.11, 6.2.1).
#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <vector>

#include "sim/usb/device.h"

namespace hapticd::sim::usb {

/// Strings: 1 manufacturer, 2 product, 3 serial if there is one. `composite`: has interface associations.
std::vector<std::uint8_t> make_device_descriptor(std::uint16_t vendor, std::uint16_t product,
                                                 bool has_serial, bool composite = false);

class ConfigurationDescriptor {
 public:
  enum class Kind : std::uint8_t { bulk = 2, interrupt = 3 };

  ConfigurationDescriptor();
  /// Of class / subclass / protocol; opens what follows.
  ConfigurationDescriptor& interface(std::uint8_t number, std::uint8_t endpoints,
                                     std::uint8_t device_class, std::uint8_t subclass = 0,
                                     std::uint8_t protocol = 0);
  ConfigurationDescriptor& hid(std::size_t report_descriptor_bytes);
  ConfigurationDescriptor& endpoint(std::uint8_t address, Kind kind, std::uint16_t packet_bytes,
                                    std::uint8_t interval);
  ConfigurationDescriptor& raw(std::initializer_list<std::uint8_t> bytes);
  std::vector<std::uint8_t> bytes() const;

 private:
  std::vector<std::uint8_t> bytes_;
  std::uint8_t interfaces_ = 0;
};

}  // namespace hapticd::sim::usb
