#include <algorithm>
#include <utility>

#include "drivers/hid/superseding.h"
#include "drivers/usb/libusb_exchange.h"
#include "drivers/usb/libusb_port.h"

namespace hapticd::usb {
namespace {

// Device Class Definition for HID 1.11, sections 7.1 and 7.2.
constexpr std::uint8_t kFromInterface = 0xa1, kToInterface = 0x21, kStandardFromInterface = 0x81;
constexpr std::uint8_t kGetDescriptor = 0x06, kGetReport = 0x01, kSetReport = 0x09, kSetIdle = 0x0a;
constexpr std::uint16_t kReportDescriptor = 0x2200, kFeatureReport = 0x0300;

class LibusbHidPort final : public HidPort {
 public:
  LibusbHidPort(std::unique_ptr<LibusbSession> session, const ExchangeOptions& options,
                std::vector<std::uint8_t> descriptor)
      : exchange_(std::move(session), options), descriptor_(std::move(descriptor)) {}

  Arrival receive(std::int64_t until_ns) override { return exchange_.receive(until_ns); }
  Status send(std::span<const std::uint8_t> bytes) override { return exchange_.send(bytes); }
  Status flush(std::int64_t until_ns) override { return exchange_.flush(until_ns); }
  const Outgoing& outgoing() const noexcept override { return exchange_.outgoing(); }
  std::uint64_t skipped() const noexcept override { return exchange_.skipped(); }
  Status set_feature(std::span<const std::uint8_t> report) override;
  std::size_t get_feature(std::span<std::uint8_t> report) override;
  const std::vector<std::uint8_t>& report_descriptor() const noexcept override {
    return descriptor_;
  }

 private:
  std::uint16_t interface_number() noexcept {
    return static_cast<std::uint16_t>(exchange_.session().interface_number());
  }
  LibusbExchange exchange_;
  std::vector<std::uint8_t> descriptor_;
};

/// A report without id has none on the wire either.
template <class Byte>
std::span<Byte> on_the_wire(std::span<Byte> report) {
  return report.subspan(report.front() == 0 ? 1 : 0);
}

Status LibusbHidPort::set_feature(std::span<const std::uint8_t> report) {
  if (report.empty()) return Status::failed;
  const auto value = static_cast<std::uint16_t>(kFeatureReport | report.front());
  return exchange_.session().control_out(kToInterface, kSetReport, value, interface_number(),
                                         on_the_wire(report));
}

std::size_t LibusbHidPort::get_feature(std::span<std::uint8_t> report) {
  if (report.empty()) return 0;
  const auto value = static_cast<std::uint16_t>(kFeatureReport | report.front());
  const std::span<std::uint8_t> data = on_the_wire(report);
  const int got =
      exchange_.session().control_in(kFromInterface, kGetReport, value, interface_number(), data);
  if (got <= 0) return 0;
  return static_cast<std::size_t>(got) + (report.size() - data.size());
}

/// `known`: as the kernel has read it before, so that the device is asked for what it has.
std::vector<std::uint8_t> read_descriptor(LibusbSession& session, std::size_t known) {
  std::vector<std::uint8_t> bytes(known != 0 ? known : hid::kMostDescriptorBytes);
  const int got = session.control_in(kStandardFromInterface, kGetDescriptor, kReportDescriptor,
                                     static_cast<std::uint16_t>(session.interface_number()), bytes);
  bytes.resize(static_cast<std::size_t>(std::max(got, 0)));
  return bytes;
}

Endpoint interrupt_endpoint(const Interface& interface, bool in) {
  for (const Endpoint& endpoint : interface.endpoints)
    if (endpoint.type == EndpointType::interrupt && is_in(endpoint) == in) return endpoint;
  return {.address = 0};
}

/// In whole packets: a report that is a whole packet long, or shorter, ends a transfer.
std::size_t whole_packets(std::size_t bytes, std::size_t packet_bytes) {
  const std::size_t packet = std::max<std::size_t>(packet_bytes, 1);
  return std::max<std::size_t>(1, (bytes + packet - 1) / packet) * packet;
}

ExchangeOptions options_for(const Selection& selection, const Interface& interface,
                            const hid::ReportDescriptor& descriptor) {
  const Endpoint in = interrupt_endpoint(interface, true);
  return {
      .in = in,
      .in_bytes =
          whole_packets(hid::longest_report(descriptor, hid::ReportKind::input), in.packet_bytes),
      .reads = selection.reads,
      .out = {.endpoint = interrupt_endpoint(interface, false), .numbered = descriptor.numbered},
      .out_bytes =
          std::max(hid::kMostReportBytes, hid::longest_report(descriptor, hid::ReportKind::output)),
      .superseding = hid::superseding_of(descriptor)};
}

}  // namespace

Opened<Found<HidPort>> open_libusb_hid(const Selection& selection, const Roots& roots,
                                       Waker& waker) {
  const auto chosen = choose_hid_interface(selection, roots);
  if (!chosen) return tl::unexpected(chosen.error());
  auto session = LibusbSession::open(*chosen, waker);
  if (!session) return tl::unexpected(session.error());
  const About& about = chosen->device.about;
  std::vector<std::uint8_t> bytes =
      read_descriptor(**session, chosen->interface.report_descriptor.size());
  const auto descriptor = hid::parse_descriptor(bytes);
  if (!descriptor)
    return refused(ExitCode::unavailable, words(about) + ": " + descriptor.error().text);
  if (!has_usage(bytes, selection))
    return refused(ExitCode::unavailable,
                   words(about) + " has usage " + usages_of(bytes) + ", not that of usb.usage");
  // Silence while nothing changes. A device without it refuses, and does no other.
  (void)(*session)->control_out(kToInterface, kSetIdle, 0,
                                static_cast<std::uint16_t>(chosen->interface.number), {});
  const ExchangeOptions options = options_for(selection, chosen->interface, *descriptor);
  Found<HidPort> found{
      .port = std::make_unique<LibusbHidPort>(*std::move(session), options, std::move(bytes)),
      .product = about.name,
      .serial = about.serial,
      .path = about.path,
      .interval_s = options.in.interval_s};
  return found;
}

}  // namespace hapticd::usb
