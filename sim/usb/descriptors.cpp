#include "sim/usb/descriptors.h"

namespace hapticd::sim::usb {
namespace {

std::uint8_t low(std::size_t value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
std::uint8_t high(std::size_t value) {
  return static_cast<std::uint8_t>(value >> 8 & 0xff);
}

}  // namespace

std::vector<std::uint8_t> make_device_descriptor(std::uint16_t vendor, std::uint16_t product,
                                                 bool has_serial, bool composite) {
  const std::uint8_t device_class = composite ? 0xef : 0, subclass = composite ? 2 : 0,
                     protocol = composite ? 1 : 0, serial = has_serial ? 3 : 0;
  return {18,
          1,
          0x00,
          0x02,
          device_class,
          subclass,
          protocol,
          64,
          low(vendor),
          high(vendor),
          low(product),
          high(product),
          0x00,
          0x01,
          1,
          2,
          serial,
          1};
}

ConfigurationDescriptor::ConfigurationDescriptor() : bytes_{9, 2, 0, 0, 0, 1, 0, 0x80, 50} {}

ConfigurationDescriptor& ConfigurationDescriptor::interface(std::uint8_t number,
                                                            std::uint8_t endpoints,
                                                            std::uint8_t device_class,
                                                            std::uint8_t subclass,
                                                            std::uint8_t protocol) {
  ++interfaces_;
  return raw({9, 4, number, 0, endpoints, device_class, subclass, protocol, 0});
}

ConfigurationDescriptor& ConfigurationDescriptor::hid(std::size_t report_descriptor_bytes) {
  return raw({9, 0x21, 0x11, 0x01, 0, 1, 0x22, low(report_descriptor_bytes),
              high(report_descriptor_bytes)});
}

ConfigurationDescriptor& ConfigurationDescriptor::endpoint(std::uint8_t address, Kind kind,
                                                           std::uint16_t packet_bytes,
                                                           std::uint8_t interval) {
  return raw({7, 5, address, static_cast<std::uint8_t>(kind), low(packet_bytes), high(packet_bytes),
              interval});
}

ConfigurationDescriptor& ConfigurationDescriptor::raw(std::initializer_list<std::uint8_t> bytes) {
  bytes_.insert(bytes_.end(), bytes);
  return *this;
}

std::vector<std::uint8_t> ConfigurationDescriptor::bytes() const {
  std::vector<std::uint8_t> all = bytes_;
  all[2] = low(all.size());
  all[3] = high(all.size());
  all[4] = interfaces_;
  return all;
}

}  // namespace hapticd::sim::usb
