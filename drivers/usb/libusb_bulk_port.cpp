#include <utility>

#include "drivers/usb/libusb_exchange.h"
#include "drivers/usb/libusb_port.h"

namespace hapticd::usb {
namespace {

constexpr std::size_t kMostSent = 512;

class LibusbBulkPort final : public BulkPort {
 public:
  LibusbBulkPort(std::unique_ptr<LibusbSession> session, const ExchangeOptions& options)
      : exchange_(std::move(session), options) {}

  Arrival receive(std::int64_t until_ns) override { return exchange_.receive(until_ns); }
  Status send(std::span<const std::uint8_t> bytes) override { return exchange_.send(bytes); }
  Status flush(std::int64_t until_ns) override { return exchange_.flush(until_ns); }
  const Outgoing& outgoing() const noexcept override { return exchange_.outgoing(); }
  std::uint64_t skipped() const noexcept override { return exchange_.skipped(); }
  Status request(std::uint8_t type, std::uint8_t request, std::uint16_t value) override {
    return exchange_.session().control_out(type, request, value, 0, {});
  }

 private:
  LibusbExchange exchange_;
};

Endpoint endpoint_of(const Interface& interface, std::uint8_t address) {
  for (const Endpoint& endpoint : interface.endpoints)
    if (endpoint.address == address) return endpoint;
  return {};
}

}  // namespace

Opened<Found<BulkPort>> open_libusb_bulk(const Selection& selection, std::uint8_t bulk_in,
                                         std::uint8_t bulk_out, const Roots& roots, Waker& waker) {
  const auto chosen = choose_bulk(selection, bulk_in, bulk_out, roots);
  if (!chosen) return tl::unexpected(chosen.error());
  auto session = LibusbSession::open(*chosen, waker);
  if (!session) return tl::unexpected(session.error());
  const Endpoint in = endpoint_of(chosen->interface, bulk_in);
  // One packet a transfer: a longer one that is filled with whole packets does not end before the next short one.
  const ExchangeOptions options{.in = in,
                                .in_bytes = std::max<std::size_t>(in.packet_bytes, 1),
                                .reads = selection.reads,
                                .out = {.endpoint = endpoint_of(chosen->interface, bulk_out)},
                                .out_bytes = kMostSent,
                                .superseding = {}};
  Found<BulkPort> found{.port = std::make_unique<LibusbBulkPort>(*std::move(session), options),
                        .product = chosen->device.about.name,
                        .serial = chosen->device.about.serial,
                        .path = chosen->device.about.path,
                        .interval_s = in.interval_s};
  return found;
}

}  // namespace hapticd::usb
