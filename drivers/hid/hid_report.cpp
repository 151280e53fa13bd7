#include "drivers/hid/hid_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "drivers/hid/report_descriptor.h"

namespace hapticd::hid {
namespace {

using usb::Arrival;
using usb::Heard;
using usb::NotOpened;
using usb::Opened;
using usb::Status;

constexpr int kMeasured = 20;

tl::unexpected<NotOpened> refuse(ExitCode code, std::string text) {
  return tl::unexpected(NotOpened{false, Error{std::move(text), code}});
}
tl::unexpected<NotOpened> unplugged() {
  return tl::unexpected(
      NotOpened{true, Error{"unplugged while it was set up", ExitCode::unavailable}});
}

std::string report_name(std::optional<std::uint8_t> id) {
  return id ? "report " + std::to_string(*id) : "a report without id";
}

/// How a map differs from what the device says of its reports; empty: it does not.
template <class Map>
std::string misfit(const ReportDescriptor& descriptor, const Map& map, ReportKind kind,
                   const std::string& key) {
  const std::string begin = key + " describes " + report_name(map.report_id) + " of " +
                            std::to_string(map.report_bytes) + " bytes, but the device ";
  const std::uint8_t id = map.report_id.value_or(0);
  switch (fit(descriptor, map)) {
    case Fit::ok:
      return {};
    case Fit::no_such_report:
      return begin + "has none such; its reports have " + (descriptor.numbered ? "ids" : "no ids");
    case Fit::report_length:
      return begin + "says that it has " + std::to_string(descriptor.report_bytes(kind, id));
    case Fit::outside:
      return begin + "declares fewer bits than a field reaches to";
  }
  return {};
}

std::int64_t ns(double seconds) {
  return std::llround(1e9 * seconds);
}
double median_s(std::vector<std::int64_t> took_ns) {
  const auto middle = took_ns.begin() + static_cast<std::ptrdiff_t>(took_ns.size() / 2);
  std::ranges::nth_element(took_ns, middle);
  return 1e-9 * static_cast<double>(*middle);
}
std::string ms(double seconds) {
  const long tenths = std::lround(1e4 * seconds);
  return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " ms";
}

}  // namespace

double HidReport::carried(std::size_t axis, double effort) const noexcept {
  return hid::carried(options_.report.out.fields[axis], effort);
}

// -- set-up

Opened<usb::Identity> HidReport::open(usb::Host& host, usb::Words& words) {
  words.say("opens it");
  auto found = host.open_hid(options_.selection);
  if (!found) return tl::unexpected(found.error());
  found_ = std::move(*found);
  state_ = {};
  armed_ = false;
  auto good = compare();
  if (good) {
    words.say("measures how often it reports");
    good = measure(host);
  }
  if (!good) {
    const NotOpened why = good.error();
    close(host, host.now_ns() + ns(0.02));
    return tl::unexpected(why);
  }
  return usb::Identity{found_.product.empty() ? "HID device" : found_.product, found_.serial};
}

/// The maps with the device's own description of its reports.
Opened<bool> HidReport::compare() {
  const auto descriptor = parse_descriptor(found_.port->report_descriptor());
  if (!descriptor)
    return refuse(ExitCode::unavailable,
                  "its report descriptor cannot be understood: " + descriptor.error().text);
  const usb::ReportOptions& report = options_.report;
  for (const std::string& text :
       {misfit(*descriptor, report.in, ReportKind::input, "report.in"),
        misfit(*descriptor, report.out, ReportKind::output, "report.out")})
    if (!text.empty()) return refuse(ExitCode::bad_data, text);
  return true;
}

Opened<bool> HidReport::measure(usb::Host& host) {
  if (auto heard = measure_reports(host); !heard) return heard;
  return measure_sending(host);
}

/// It has to report often enough for the age that the config allows, without being asked.
Opened<bool> HidReport::measure_reports(usb::Host& host) {
  const std::int64_t until_ns = host.now_ns() + ns(std::max(0.2, 2 * options_.silence_s));
  std::vector<std::int64_t> between_ns;
  std::int64_t last_ns = 0;
  while (static_cast<int>(between_ns.size()) < kMeasured && host.now_ns() < until_ns) {
    // Some report only to who speaks to them.
    if (found_.port->send(safe_report(options_.report.out, ++heartbeat_).report()) == Status::gone)
      return unplugged();
    const Arrival arrival = found_.port->receive(std::min(until_ns, host.now_ns() + ns(0.005)));
    if (arrival.status == Status::gone) return unplugged();
    if (arrival.status == Status::stalled || arrival.status == Status::failed)
      return refuse(ExitCode::unavailable, "its reports cannot be read: it refuses transfers");
    if (decode(options_.report.in, arrival.bytes).received != Received::ok) continue;
    if (last_ns != 0) between_ns.push_back(arrival.stamp_ns - last_ns);
    last_ns = arrival.stamp_ns;
  }
  if (static_cast<int>(between_ns.size()) < kMeasured)
    return refuse(ExitCode::unavailable, "it sent " + std::to_string(between_ns.size()) +
                                             " reports as report.in describes "
                                             "them in " +
                                             ms(std::max(0.2, 2 * options_.silence_s)) +
                                             "; expected one in every "
                                             "period of the loop");
  const double every_s = median_s(between_ns);
  const double most_s = options_.worst_sample_age_s - options_.arrival_age_s;
  if (every_s <= most_s) return true;
  return refuse(ExitCode::unavailable, "it reports every " + ms(every_s) +
                                           " (median); with usb.max_age_s and "
                                           "usb.arrival_age_s as they are it may take " +
                                           ms(most_s) +
                                           " at most: raise usb.max_age_s, and latency_s with it");
}

Opened<bool> HidReport::measure_sending(usb::Host& host) {
  std::vector<std::int64_t> took_ns;
  while (static_cast<int>(took_ns.size()) < kMeasured) {
    Status status = found_.port->send(safe_report(options_.report.out, ++heartbeat_).report());
    if (status == Status::ok) status = found_.port->flush(host.now_ns() + ns(0.1));
    if (status == Status::gone) return unplugged();
    if (status != Status::ok)
      return refuse(ExitCode::unavailable, "it takes no report of " +
                                               std::to_string(options_.report.out.report_bytes) +
                                               " bytes as report.out describes it");
    took_ns.push_back(found_.port->outgoing().last_took_ns);
  }
  round_trip_s_ = median_s(took_ns);
  // A command may have to wait for the one that is on its way.
  if (2 * round_trip_s_ <= options_.send_s) return true;
  return refuse(ExitCode::unavailable, "a report takes " + ms(round_trip_s_) +
                                           " on its way out (median) and may wait for "
                                           "another; the config assumes at most " +
                                           ms(options_.send_s) +
                                           " for both: raise usb.send_s, and latency_s with "
                                           "it; or try usb.transport: libusb");
}

// -- exchange

Heard HidReport::take(std::span<const std::uint8_t> bytes, std::int64_t, usb::Reading& reading) {
  Reading read = decode(options_.report.in, bytes);
  if (read.received == Received::ignore) return Heard::nothing;
  if (read.received != Received::ok) return Heard::malformed;
  const Sequence::Step step = follow(options_.report.in, state_, read);
  if (step.order == Sequence::Order::repeated) return Heard::nothing;
  if (step.order == Sequence::Order::back) {
    fault_ = "its sequence number went back: it has restarted, and may count from elsewhere";
    return Heard::restarted;
  }
  lost_ += step.lost;
  copy(read, reading);
  return Heard::sample;
}

void HidReport::copy(const Reading& from, usb::Reading& to) const {
  const std::size_t axes = options_.axes.size(), buttons = options_.report.buttons;
  std::copy_n(from.value.begin(), axes, to.counts.begin());
  to.digital = 0;
  for (std::size_t i = 0; i < buttons; ++i)
    if (from.raw[axes + i] != 0) to.digital |= 1u << i;
  const std::size_t analogue = options_.report.in.fields.size() - axes - buttons;
  std::copy_n(from.value.begin() + static_cast<std::ptrdiff_t>(axes + buttons),
              std::min(analogue, to.analogue.size()), to.analogue.begin());
  to.armed = armed_;
}

/// Without force the board gets its safe report, which may switch its amplifiers off.
Encoded HidReport::encoded(const usb::Command& command) {
  ++heartbeat_;
  if (command.armed) {
    const auto report =
        encode(options_.report.out, {command.effort.data(), options_.axes.size()}, heartbeat_);
    if (report) return *report;
  }
  return safe_report(options_.report.out, heartbeat_);
}

Status HidReport::tell(const usb::Command& command, std::int64_t) {
  armed_ = command.armed;
  return found_.port->send(encoded(command).report());
}

void HidReport::close(usb::Host& host, std::int64_t until_ns) noexcept {
  if (found_.port)
    usb::send_last(host, *found_.port, until_ns,
                   [&] { return found_.port->send(encoded({}).report()); });
  found_ = {};
  armed_ = false;
}

}  // namespace hapticd::hid
