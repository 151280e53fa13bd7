#include "drivers/usb/falcon.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hapticd::usb {
namespace {

using falcon::Upload;

constexpr std::int64_t kAnswer_ns = 20'000'000;  ///< a packet's answer takes 1 to 2 ms
constexpr int kProbes = 10;         ///< packets without an answer: there is no firmware
constexpr int kMeasured = 50;       ///< exchanges, of which
constexpr int kLeastAnswered = 45;  ///< so many must have an answer

tl::unexpected<NotOpened> refuse(ExitCode code, std::string text) {
  return tl::unexpected(NotOpened{false, Error{std::move(text), code}});
}
tl::unexpected<NotOpened> unplugged(const char* when) {
  return tl::unexpected(
      NotOpened{true, Error{std::string("unplugged ") + when, ExitCode::unavailable}});
}

const char* words_of(Upload upload) {
  switch (upload) {
    case Upload::no_greeting:
      return "it does not answer its greeting; is its mains adaptor plugged in?";
    case Upload::no_start:
      return "it does not begin to load";
    case Upload::wrong_echo:
      return "it does not send back what it was sent";
    case Upload::done:
    case Upload::unplugged:
      break;
  }
  return "it does not answer after the upload";
}

std::string ms(double seconds) {
  return std::to_string(std::lround(1e4 * seconds) / 10) + "." +
         std::to_string(std::lround(1e4 * seconds) % 10) + " ms";
}

}  // namespace

double Falcon::motor_counts(double effort_Nm) const noexcept {
  const double most = options_.falcon.max_command;
  return std::clamp(std::round(effort_Nm * options_.falcon.counts_per_Nm), -most, most);
}

double Falcon::carried(std::size_t, double effort_Nm) const noexcept {
  return motor_counts(effort_Nm) / options_.falcon.counts_per_Nm;
}

// -- set-up

Opened<Identity> Falcon::open(Host& host, Words& words) {
  if (auto read = read_file(); !read) return tl::unexpected(read.error());
  auto found = host.open_bulk(options_.selection, falcon::kBulkIn, falcon::kBulkOut);
  if (!found) return tl::unexpected(found.error());
  found_ = std::move(*found);
  auto ready = set_up(host, words);
  if (!ready) {
    close(host, host.now_ns() + kAnswer_ns);
    return tl::unexpected(ready.error());
  }
  return Identity{found_.product.empty() ? "Novint Falcon" : found_.product, found_.serial};
}

/// Once: what is loaded again later is what was checked at first.
Opened<bool> Falcon::read_file() {
  const FalconOptions& falcon = options_.falcon;
  if (falcon.firmware.empty() || firmware_) return true;
  auto read = falcon::read_firmware(falcon.firmware, falcon.sha256);
  if (!read) return tl::unexpected(NotOpened{false, read.error()});
  firmware_ = std::move(*read);
  return true;
}

Opened<bool> Falcon::set_up(Host& host, Words& words) {
  words.say("asks whether it has firmware");
  receiver_ = {};
  homed_ = 0;
  armed_ = false;
  gone_ = false;
  const bool settable = falcon::set_up_run(*found_.port, options_.falcon.flush_on_bracket);
  if (!settable || !answers(host)) {
    if (gone_) return unplugged("while it was asked for its firmware");
    if (auto loaded = load(host, words); !loaded) return loaded;
  }
  return measure(host, words);
}

Opened<bool> Falcon::load(Host& host, Words& words) {
  if (!firmware_)
    return refuse(
        ExitCode::unavailable,
        "the Falcon has no firmware, and hapticd has none of its own (its licence forbids "
        "that): give falcon.firmware, the file that came with the device");
  Upload came = Upload::no_greeting;
  for (int i = 0; i < options_.falcon.upload_tries && !words.abandoned(); ++i) {
    came = falcon::upload(*found_.port, host, words, *firmware_);
    if (came == Upload::unplugged) return unplugged("while firmware was loaded");
    if (came != Upload::done) continue;
    receiver_ = {};
    if (falcon::set_up_run(*found_.port, options_.falcon.flush_on_bracket) && answers(host))
      return true;
  }
  return refuse(ExitCode::unavailable,
                std::string("firmware could not be loaded: ") + words_of(came) + " (" +
                    std::to_string(options_.falcon.upload_tries) + " tries, " +
                    options_.falcon.firmware + ", SHA-256 " + firmware_->sha256 + ")");
}

bool Falcon::answers(Host& host) {
  for (int i = 0; i < kProbes; ++i)
    if (exchange_once(host)) return true;
  return false;
}

/// A packet without force, and the time until its answer; nothing: none came.
std::optional<std::int64_t> Falcon::exchange_once(Host& host) {
  const std::int64_t start_ns = host.now_ns(), until_ns = start_ns + kAnswer_ns;
  const Status sent = send({});
  gone_ = sent == Status::gone;
  if (sent != Status::ok) return {};
  while (host.now_ns() < until_ns) {
    const Arrival arrival = found_.port->receive(until_ns);
    if (arrival.status == Status::nothing) continue;
    gone_ = arrival.status == Status::gone;
    if (arrival.status != Status::ok) return {};
    if (receiver_.take(arrival.bytes).newest) return arrival.stamp_ns - start_ns;
  }
  return {};
}

/// What the config says of the way there and back has to hold on this machine, at this hub.
Opened<bool> Falcon::measure(Host& host, Words& words) {
  words.say("measures its round trip");
  std::vector<std::int64_t> took_ns;
  for (int i = 0; i < kMeasured && !words.abandoned(); ++i)
    if (const auto one = exchange_once(host)) took_ns.push_back(*one);
  if (gone_) return unplugged("while its round trip was measured");
  if (static_cast<int>(took_ns.size()) < kLeastAnswered)
    return refuse(ExitCode::unavailable,
                  "it answered " + std::to_string(took_ns.size()) + " of " +
                      std::to_string(kMeasured) +
                      " packets: unplug it from USB and mains, and plug it in again");
  std::ranges::sort(took_ns);
  round_trip_s_ = 1e-9 * static_cast<double>(took_ns.back());
  const double median_s = 1e-9 * static_cast<double>(took_ns[took_ns.size() / 2]);
  const double assumed_s = options_.send_s / 2 + options_.arrival_age_s;
  if (median_s <= assumed_s) return true;
  return refuse(ExitCode::unavailable, "a packet and its answer take " + ms(median_s) +
                                           " (median), the config assumes at most " +
                                           ms(assumed_s) +
                                           ", usb.send_s / 2 + usb.arrival_age_s: raise these, and "
                                           "latency_s with them; or use another USB port");
}

// -- exchange

Heard Falcon::take(std::span<const std::uint8_t> bytes, std::int64_t, Reading& reading) {
  const std::uint64_t dropped = receiver_.stream().dropped();
  const auto received = receiver_.take(bytes);
  if (!received.newest)
    return receiver_.stream().dropped() != dropped || received.line_error ? Heard::malformed
                                                                          : Heard::nothing;
  const falcon::Sample& sample = *received.newest;
  std::ranges::copy(sample.encoder_counts, reading.counts.begin());
  reading.homed = homed_ = sample.homed;
  reading.digital = sample.buttons;
  reading.armed = armed_;
  return Heard::sample;
}

Status Falcon::tell(const Command& command, std::int64_t) {
  armed_ = command.armed;
  return send(command);
}

Status Falcon::send(const Command& command) {
  const bool homed = homed_ == falcon::kAllHomed;
  falcon::Command packet{.homing = !homed,
                         .green = homed && command.armed,
                         .blue = homed && !command.armed,
                         .red = !homed};
  // Where the zeros are not known no force has a direction.
  for (std::size_t i = 0; i < packet.motor_counts.size(); ++i)
    packet.motor_counts[i] = homed && command.armed ? motor_counts(command.effort[i]) : 0;
  const auto encoded = falcon::encode(packet);
  return encoded ? found_.port->send(encoded->packet) : Status::failed;
}

void Falcon::close(Host& host, std::int64_t until_ns) noexcept {
  if (found_.port) send_last(host, *found_.port, until_ns, [&] { return send({}); });
  found_ = {};
  armed_ = false;
}

}  // namespace hapticd::usb
