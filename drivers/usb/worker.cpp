#include "drivers/usb/worker.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <string>

namespace hapticd::usb {
namespace {

constexpr std::int64_t kFirstRetry_ns = 100'000'000, kLastRetry_ns = 1'000'000'000;
/// For zero force on the way out: a healthy device takes two frames for it.
constexpr std::int64_t kWayOut_ns = 20'000'000;
constexpr std::int64_t kLeastUnsent_ns = 5'000'000;

std::int64_t ns(double seconds) {
  return std::llround(1e9 * seconds);
}

std::string_view word_of(Status status) {
  switch (status) {
    case Status::gone:
      return "unplugged";
    case Status::stalled:
      return "it refuses transfers (stalled)";
    case Status::ok:
    case Status::nothing:
    case Status::failed:
      break;
  }
  return "its transfers fail";
}

}  // namespace

Worker::Worker(const DeviceOptions& options, Host& host, Protocol& protocol, Exchange& exchange)
    : options_(options), host_(host), protocol_(protocol), exchange_(exchange) {}

void Worker::end() noexcept {
  ending_.store(true, std::memory_order_relaxed);
  host_.wake();
}

void Worker::say(std::string_view text) {
  exchange_.doing.begin().add(options_.name).add(": ").add(text).publish();
}

void Worker::run() {
  std::int64_t retry_ns = kFirstRetry_ns;
  while (!abandoned()) {
    const auto opened = open();
    if (opened) {
      connect(*opened);
      came_of_looking(opened);
      exchange();
      disconnect();
      retry_ns = kFirstRetry_ns;
    } else {
      say(opened.error().error.text);
      came_of_looking(opened);
    }
    const std::int64_t until_ns = host_.now_ns() + retry_ns;
    while (!abandoned() && host_.now_ns() < until_ns) host_.wait(until_ns);
    retry_ns = std::min(2 * retry_ns, kLastRetry_ns);
  }
}

/// What is thrown on the way (out of memory) is no reason to end the process, in which other devices are driven.
Opened<Identity> Worker::open() {
  try {
    return protocol_.open(host_, *this);
  } catch (const std::exception& error) {
    protocol_.close(host_, host_.now_ns() + kWayOut_ns);
    return tl::unexpected(NotOpened{
        false,
        Error{std::string("it could not be set up: ") + error.what(), ExitCode::unavailable}});
  }
}

void Worker::came_of_looking(const Opened<Identity>& opened) {
  if (first() != nullptr) return;
  if (opened)
    first_.found = *opened;
  else
    first_.why = opened.error();
  known_.store(true, std::memory_order_release);
}

void Worker::connect(const Identity& identity) {
  identity_ = identity;
  const std::int64_t now_ns = host_.now_ns();
  link_ = ++exchange_.connections;
  reading_ = {.link = link_};
  command_ = {};
  next_tell_ns_ = heard_ns_ = now_ns;
  exchange_.traffic.round_trip_ns.store(ns(protocol_.round_trip_s()), std::memory_order_relaxed);
  exchange_.traffic.connections.store(link_, std::memory_order_relaxed);
  exchange_.link.store(link_, std::memory_order_release);
}

void Worker::exchange() {
  while (!abandoned()) {
    if (!tell_if_due() || !takes_commands()) return;
    const Arrival arrival = protocol_.port()->receive(next_tell_ns_);
    if (arrival.status == Status::ok) {
      if (!hear(arrival)) return;
    } else if (arrival.status != Status::nothing) {
      lost(arrival.status);
      return;
    }
    if (!speaks()) return;
  }
}

/// False: the device is lost.
bool Worker::tell_if_due() {
  const std::int64_t now_ns = host_.now_ns();
  const std::uint64_t given = exchange_.command.count();
  if (given == told_ && now_ns < next_tell_ns_) return true;
  const Command wanted = command_now(now_ns);
  told_ = given;
  const Status status = protocol_.tell(wanted, now_ns);
  next_tell_ns_ = protocol_.tell_again_ns(now_ns);
  // A force has to be taken back as soon as it is too old.
  if (wanted.armed)
    next_tell_ns_ = std::min(next_tell_ns_, wanted.at_ns + ns(options_.watchdog_s) + 1);
  count();
  return status == Status::ok || status == Status::nothing || lost(status);
}

Command Worker::command_now(std::int64_t now_ns) {
  (void)exchange_.command.load(command_);  // or the one before, once more
  const bool ours = command_.link == link_;
  const bool young = now_ns - command_.at_ns <= ns(options_.watchdog_s);
  if (ours && young && command_.armed) return command_;
  return {.at_ns = now_ns, .link = link_};
}

/// False: the device is lost.
bool Worker::hear(const Arrival& arrival) {
  switch (protocol_.take(arrival.bytes, arrival.stamp_ns, reading_)) {
    case Heard::nothing:
      break;
    case Heard::malformed:
      exchange_.traffic.malformed.fetch_add(1, std::memory_order_relaxed);
      break;
    case Heard::sample:
      reading_.stamp_ns = arrival.stamp_ns;
      heard_ns_ = std::max(heard_ns_, arrival.stamp_ns);
      exchange_.reading.store(reading_);
      break;
    case Heard::fault:
      exchange_.lost.begin().add(options_.name).add(": ").add(protocol_.fault_text()).publish();
      ++reading_.failures;
      exchange_.reading.store(reading_);
      break;
    case Heard::restarted:
      return lost(protocol_.fault_text());
  }
  return true;
}

/// False: it is lost.
bool Worker::speaks() {
  const std::int64_t silent_ns = host_.now_ns() - heard_ns_;
  if (silent_ns <= ns(options_.silence_s)) return true;
  return lost("no sample came for", silent_ns / 1'000'000);
}

/// A transport that waits for each report tells afterwards. False: it is lost.
bool Worker::takes_commands() {
  constexpr double kUnsent = 5;  // times what a command may take
  const Outgoing& outgoing = protocol_.port()->outgoing();
  const std::int64_t under_way_ns =
      outgoing.since_ns != 0 ? host_.now_ns() - outgoing.since_ns : outgoing.last_took_ns;
  if (under_way_ns <= std::max(kLeastUnsent_ns, ns(kUnsent * options_.send_s))) return true;
  return lost("it has not taken a command for", under_way_ns / 1'000'000);
}

bool Worker::lost(Status status) {
  return lost(word_of(status));
}

/// The loop knows it before anything else is tried.
bool Worker::lost(std::string_view why, std::int64_t milliseconds) {
  drivers::FaultText& text = exchange_.lost.begin().add(options_.name).add(" (");
  text.add(identity_.model).add(identity_.serial.empty() ? "" : ", serial ").add(identity_.serial);
  text.add("): ").add(why);
  if (milliseconds >= 0) text.add(" ").add(milliseconds).add(" ms");
  text.publish();
  exchange_.link.store(0, std::memory_order_release);
  return false;
}

void Worker::disconnect() {
  exchange_.link.store(0, std::memory_order_release);
  say("looks for it again");
  replaced_before_ += protocol_.port()->outgoing().replaced;
  skipped_before_ += protocol_.port()->skipped();
  protocol_.close(host_, host_.now_ns() + kWayOut_ns);
}

void Worker::count() {
  const Port& port = *protocol_.port();
  drivers::Traffic& traffic = exchange_.traffic;
  traffic.not_sent.store(replaced_before_ + port.outgoing().replaced, std::memory_order_relaxed);
  traffic.lost.store(protocol_.lost(), std::memory_order_relaxed);
  traffic.late.store(skipped_before_ + port.skipped(), std::memory_order_relaxed);
  worst_send_ns_ = std::max(worst_send_ns_, port.outgoing().worst_took_ns);
  traffic.worst_send_ns.store(worst_send_ns_, std::memory_order_relaxed);
}

}  // namespace hapticd::usb
