#include "sim/usb/falcon.h"

#include "sim/usb/descriptors.h"

namespace hapticd::sim::usb {

Falcon::Falcon(const FalconOptions& options)
    : options_(options), bridge_(options.bridge), board_(options.board, bridge_) {}

std::vector<std::uint8_t> Falcon::device_descriptor() const {
  return make_device_descriptor(options_.vendor, options_.product, !options_.serial.empty());
}

std::vector<std::uint8_t> Falcon::configuration_descriptor() const {
  using Kind = ConfigurationDescriptor::Kind;
  return ConfigurationDescriptor()
      .interface(0, 2, 0xff, 0xff, 0xff)
      .endpoint(0x80 | kIn, Kind::bulk, FtdiBridge::kPacketBytes, 0)
      .endpoint(kOut, Kind::bulk, FtdiBridge::kPacketBytes, 0)
      .bytes();
}

Names Falcon::names() const {
  return {.manufacturer = "FTDI", .product = "FALCON HAPTIC", .serial = options_.serial};
}

Answer Falcon::control(const Setup& setup, std::span<const std::uint8_t>, std::int64_t now_ns) {
  board_.advance(now_ns);
  Answer answer = bridge_.request(setup, now_ns);
  board_.advance(now_ns);  // sees each edge of a pin
  return answer;
}

Answer Falcon::out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                   std::int64_t now_ns) {
  return endpoint == kOut ? bridge_.out(bytes, now_ns) : Answer{.kind = Answer::Kind::stall};
}

Answer Falcon::in(std::uint8_t endpoint, std::size_t most_bytes, std::int64_t now_ns) {
  return endpoint == kIn ? bridge_.in(most_bytes, now_ns) : Answer{.kind = Answer::Kind::stall};
}

void Falcon::replug(bool power_lost, std::int64_t now_ns) {
  bridge_.power_up(now_ns);
  if (power_lost)
    board_.power_up(now_ns);
  else
    board_.bridge_reset();
}

}  // namespace hapticd::sim::usb
