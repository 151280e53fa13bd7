// A device whose packets tell their number, to test what carries them.
#pragma once
#include <stdexcept>

#include "sim/usb/descriptors.h"
#include "tests/unit/emulators/usb_host.h"

namespace hapticd::test::emulator {

/// Bulk 0x81 and 0x01, interrupt 0x83 and 0x03 with interval 4. IN packets carry their number.
class NumberingDevice final : public sim::usb::Device {
 public:
  explicit NumberingDevice(sim::usb::Speed speed = sim::usb::Speed::full) : speed_(speed) {}
  sim::usb::Speed speed() const override { return speed_; }
  UsbBytes device_descriptor() const override {
    return sim::usb::make_device_descriptor(1, 2, true);
  }
  UsbBytes configuration_descriptor() const override {
    using Kind = sim::usb::ConfigurationDescriptor::Kind;
    return sim::usb::ConfigurationDescriptor()
        .interface(0, 4, 0xff)
        .hid(3)
        .endpoint(0x81, Kind::bulk, 64, 0)
        .endpoint(0x01, Kind::bulk, 64, 0)
        .endpoint(0x83, Kind::interrupt, 64, 4)
        .endpoint(0x03, Kind::interrupt, 64, 4)
        .bytes();
  }
  sim::usb::Names names() const override { return {.product = "M\u00fchle"}; }
  UsbBytes report_descriptor(int interface) const override {
    return interface == 0 ? UsbBytes{1, 2, 3} : UsbBytes{};
  }
  sim::usb::Answer control(const sim::usb::Setup& setup, std::span<const std::uint8_t>,
                           std::int64_t) override {
    ++controls;
    return setup.request == 7 ? sim::usb::Answer{.bytes = {9, 8, 7}}
                              : sim::usb::Answer{.kind = sim::usb::Answer::Kind::stall};
  }
  sim::usb::Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                       std::int64_t now_ns) override {
    if (now_ns < deaf_until_ns) return {.kind = sim::usb::Answer::Kind::nak};
    taken.push_back({endpoint, now_ns, UsbBytes(bytes.begin(), bytes.end())});
    return {};
  }
  sim::usb::Answer in(std::uint8_t, std::size_t, std::int64_t) override {
    if (packets == 0) return {.kind = sim::usb::Answer::Kind::nak};
    if (packets > 0) --packets;
    ++given;
    UsbBytes bytes(packet_bytes, static_cast<std::uint8_t>(given));
    return {.bytes = bytes};
  }
  void advance(std::int64_t) override {}
  std::int64_t next_ns() const override { return sim::usb::kNever; }
  void replug(bool power_lost, std::int64_t) override { lost += power_lost ? 1 : 0; }
  std::size_t motors() const override { return 0; }
  sim::Motor& motor(std::size_t) override { throw std::logic_error("none"); }

  struct Taken {
    std::uint8_t endpoint = 0;
    std::int64_t at_ns = 0;
    UsbBytes bytes{};
  };
  std::vector<Taken> taken;
  int packets = -1;  ///< that it has; < 0: always one more
  std::size_t packet_bytes = 8;
  int given = 0, controls = 0, lost = 0;
  std::int64_t deaf_until_ns = 0;

 private:
  sim::usb::Speed speed_;
};

}  // namespace hapticd::test::emulator
