#include "sim/usb/report_board.h"

#include <algorithm>
#include <cmath>

#include "sim/usb/descriptors.h"
#include "sim/usb/hid_items.h"

namespace hapticd::sim::usb {
namespace {

enum HidClassRequest : std::uint8_t {
  kGetReport = 0x01,
  kGetIdle = 0x02,
  kGetProtocol = 0x03,
  kSetReport = 0x09,
  kSetIdle = 0x0a,
  kSetProtocol = 0x0b,
};
constexpr std::uint8_t kInputReport = 1, kOutputReport = 2;
constexpr std::uint16_t kHidPacketBytes = 64;

std::size_t with_id(const std::optional<std::uint8_t>& id, std::size_t bytes) {
  return bytes + (id ? 1 : 0);
}

}  // namespace

ReportBoard::ReportBoard(const ReportBoardOptions& options)
    : options_(options),
      motors_(options.positions.size()),
      buttons_(options.buttons.size()),
      analogue_(options.analogue.size()) {}

std::vector<std::uint8_t> ReportBoard::device_descriptor() const {
  return make_device_descriptor(options_.vendor, options_.product_id, !options_.serial.empty());
}

std::vector<std::uint8_t> ReportBoard::configuration_descriptor() const {
  using Kind = ConfigurationDescriptor::Kind;
  constexpr std::uint8_t kHidClass = 3;
  ConfigurationDescriptor all;
  for (std::size_t i = 0; i < options_.interfaces.size(); ++i) {
    const ReportBoardOptions::Interface& one = options_.interfaces[i];
    const int endpoints = (one.in_endpoint != 0 ? 1 : 0) + (one.out_endpoint != 0 ? 1 : 0);
    all.interface(static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(endpoints), kHidClass)
        .hid(report_descriptor(static_cast<int>(i)).size());
    if (one.in_endpoint != 0)
      all.endpoint(0x80 | one.in_endpoint, Kind::interrupt, kHidPacketBytes, options_.interval);
    if (one.out_endpoint != 0)
      all.endpoint(one.out_endpoint, Kind::interrupt, kHidPacketBytes, options_.interval);
  }
  return all.bytes();
}

Names ReportBoard::names() const {
  return {.manufacturer = options_.manufacturer,
          .product = options_.product,
          .serial = options_.serial};
}

std::vector<std::uint8_t> ReportBoard::report_descriptor(int interface) const {
  if (interface < 0 || static_cast<std::size_t>(interface) >= options_.interfaces.size()) return {};
  const auto& one = options_.interfaces[static_cast<std::size_t>(interface)];
  HidItems items;
  items.item(HidItems::usage_page, one.usage_page).item(HidItems::usage, one.usage);
  items.open(HidItems::application).range(0, 255);
  const auto report = [&items](HidItems::Tag way, const std::optional<std::uint8_t>& id,
                               std::size_t bytes) {
    if (bytes == 0) return;
    if (id) items.item(HidItems::report_id, *id);
    items.item(HidItems::usage, way == HidItems::input ? 1 : 2).fields(way, 8, bytes);
  };
  report(HidItems::input, one.in_id, one.in_bytes);
  report(HidItems::output, one.out_id, one.out_bytes);
  return items.close().bytes();
}

Answer ReportBoard::control(const Setup& setup, std::span<const std::uint8_t> data,
                            std::int64_t now_ns) {
  constexpr std::uint8_t kClassIn = 0xa1, kClassOut = 0x21;
  if (setup.request_type != kClassIn && setup.request_type != kClassOut)
    return {.kind = Answer::Kind::stall};
  const auto kind = static_cast<std::uint8_t>(setup.value >> 8);
  switch (setup.request) {
    case kSetIdle:
    case kSetProtocol:
      return {};
    case kGetIdle:
      return {.bytes = {0}};
    case kGetProtocol:
      return {.bytes = {1}};
    case kGetReport:
      if (kind != kInputReport || setup.index != 0) return {.kind = Answer::Kind::stall};
      return {.bytes = report()};
    case kSetReport:
      if (kind != kOutputReport || setup.index != 0) return {.kind = Answer::Kind::stall};
      return take(data, now_ns);
    default:
      return {.kind = Answer::Kind::stall};
  }
}

Answer ReportBoard::out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                        std::int64_t now_ns) {
  const std::uint8_t own = options_.interfaces.front().out_endpoint;
  return endpoint == own && own != 0 ? take(bytes, now_ns) : Answer{};
}

/// Another size or id than that of its output report: ignored, as firmware does.
Answer ReportBoard::take(std::span<const std::uint8_t> bytes, std::int64_t now_ns) {
  const ReportBoardOptions::Interface& own = options_.interfaces.front();
  if (bytes.size() != with_id(own.out_id, own.out_bytes)) return {};
  if (own.out_id && bytes[0] != *own.out_id) return {};
  const auto report = bytes.subspan(own.out_id ? 1 : 0);
  if (!options_.oldest_first) {
    obey(report, now_ns);
    return {};
  }
  if (waiting_.size() >= options_.queue) return {.kind = Answer::Kind::nak};
  if (waiting_.empty()) takes_next_ns_ = std::max(takes_next_ns_, now_ns);
  waiting_.emplace_back(report.begin(), report.end());
  return {};
}

Answer ReportBoard::in(std::uint8_t endpoint, std::size_t, std::int64_t) {
  const std::uint8_t own = options_.interfaces.front().in_endpoint;
  return endpoint == own ? Answer{.bytes = report()} : Answer{.kind = Answer::Kind::nak};
}

std::vector<std::uint8_t> ReportBoard::report() {
  const ReportBoardOptions::Interface& own = options_.interfaces.front();
  std::vector<std::uint8_t> bytes(with_id(own.in_id, own.in_bytes));
  if (own.in_id) bytes[0] = *own.in_id;
  const auto body = std::span(bytes).subspan(own.in_id ? 1 : 0);
  for (std::size_t i = 0; i < motors_.size(); ++i)
    put_field(body, options_.positions[i], std::llround(motors_[i].counts_));
  for (std::size_t i = 0; i < buttons_.size(); ++i)
    put_field(body, options_.buttons[i], buttons_[i]);
  for (std::size_t i = 0; i < analogue_.size(); ++i)
    put_field(body, options_.analogue[i], analogue_[i]);
  if (options_.sequence) put_field(body, *options_.sequence, sequence_++);
  return bytes;
}

void ReportBoard::obey(std::span<const std::uint8_t> report, std::int64_t now_ns) {
  ++taken_;
  for (std::size_t i = 0; i < std::min(motors_.size(), options_.efforts.size()); ++i) {
    const ReportBoardOptions::Effort& effort = options_.efforts[i];
    const double value = effort.per_raw * static_cast<double>(get_field(report, effort.field));
    motors_[i].torque_ = std::clamp(value, -effort.most, effort.most);
  }
  if (options_.heartbeat) {
    const std::int64_t beat = get_field(report, *options_.heartbeat);
    if (std::exchange(heartbeat_, beat) == beat) return;
  }
  fed_ns_ = now_ns;
  power(true);
}

void ReportBoard::power(bool on) {
  on_ = on;
  for (Channel& motor : motors_) motor.enabled_ = on;
}

void ReportBoard::advance(std::int64_t now_ns) {
  while (next_ns() <= now_ns) {
    const std::int64_t at_ns = next_ns();
    if (at_ns == expires_ns()) {
      power(false);
      continue;
    }
    obey(waiting_.front(), at_ns);
    waiting_.pop_front();
    takes_next_ns_ = at_ns + interval_ns();
  }
}

std::int64_t ReportBoard::next_ns() const {
  const std::int64_t takes_ns = waiting_.empty() ? kNever : takes_next_ns_;
  return std::min(takes_ns, expires_ns());
}

std::int64_t ReportBoard::expires_ns() const {
  if (!on_ || !(options_.watchdog_s > 0)) return kNever;
  return fed_ns_ + std::int64_t{std::llround(1e9 * options_.watchdog_s)};
}

std::int64_t ReportBoard::interval_ns() const {
  if (options_.speed == Speed::full) return std::int64_t{1'000'000} * options_.interval;
  return std::int64_t{125'000} << (options_.interval - 1);
}

void ReportBoard::replug(bool power_lost, std::int64_t now_ns) {
  waiting_.clear();
  fed_ns_ = takes_next_ns_ = now_ns;
  if (!power_lost) return;
  sequence_ = 0;
  heartbeat_ = -1;
  power(false);
  for (Channel& motor : motors_) motor.torque_ = 0;
}

}  // namespace hapticd::sim::usb
