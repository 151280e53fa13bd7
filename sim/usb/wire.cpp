#include "sim/usb/wire.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hapticd::sim::usb {
namespace {

constexpr std::uint8_t kIsIn = 0x80;
constexpr std::uint8_t kEndpointDescriptor = 5;
constexpr std::uint8_t kBulk = 2;
// What fits into a frame of full speed and a microframe of high speed (USB 2.0, tables 5-9 and 5-10).
constexpr int kBulkPackets[] = {19, 13};

std::size_t slot_of(std::uint8_t address) {
  return (address & 15u) | (address & kIsIn ? 16u : 0u);
}

std::int64_t frames_between(std::uint8_t interval, Speed speed) {
  const int b = std::max<int>(1, interval);
  return speed == Speed::full ? b : std::int64_t{1} << std::min(b - 1, 15);
}

}  // namespace

Wire::Wire(Device& device, const WireOptions& options)
    : device_(device), options_(options), engine_(options.seed) {
  read_endpoints();
}

void Wire::read_endpoints() {
  by_address_.fill(-1);
  configuration_ = device_.configuration_descriptor();
  for (std::size_t i = 0; i + 6 < configuration_.size(); i += configuration_[i]) {
    const std::uint8_t* d = &configuration_[i];
    if (d[0] == 0) return;
    if (d[1] != kEndpointDescriptor) continue;
    by_address_[slot_of(d[2])] = static_cast<std::int8_t>(endpoints_.size());
    endpoints_.push_back({.address = d[2],
                          .bulk = (d[3] & 3) == kBulk,
                          .packet_bytes = static_cast<std::size_t>((d[4] | d[5] << 8) & 0x7ff),
                          .every_frames = frames_between(d[6], device_.speed())});
  }
}

void Wire::set(const WireOptions& options) {
  options_ = options;
  next_frame_ = first_frame(now_ns_ + 1);
}

const Wire::Endpoint* Wire::find(std::uint8_t address) const {
  const int at = by_address_[slot_of(address)];
  return at < 0 ? nullptr : &endpoints_[static_cast<std::size_t>(at)];
}
Wire::Endpoint* Wire::find(std::uint8_t address) {
  return const_cast<Endpoint*>(std::as_const(*this).find(address));
}

void Wire::submit_out(std::uint64_t id, std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
                      std::int64_t now_ns) {
  submit(endpoint & 15,
         {.id = id, .since_ns = now_ns, .bytes = std::vector(bytes.begin(), bytes.end())});
}

void Wire::submit_in(std::uint64_t id, std::uint8_t endpoint, std::size_t most_bytes,
                     std::int64_t now_ns) {
  submit((endpoint & 15) | kIsIn, {.id = id, .since_ns = now_ns, .most_bytes = most_bytes});
}

void Wire::submit(std::uint8_t address, Transfer transfer) {
  Endpoint* endpoint = find(address);
  if (!plugged_ || endpoint == nullptr)
    return finish({.id = transfer.id,
                   .end = plugged_ ? End::stalled : End::gone,
                   .at_ns = std::max(now_ns_, transfer.since_ns)});
  endpoint->waiting.push_back(std::move(transfer));
}

bool Wire::cancel(std::uint64_t id) {
  for (Endpoint& endpoint : endpoints_)
    if (std::erase_if(endpoint.waiting, [id](const Transfer& t) { return t.id == id; }) > 0)
      return true;
  return false;
}

std::vector<Wire::Done> Wire::advance(std::int64_t now_ns) {
  const std::int64_t frame = frame_ns();
  for (std::int64_t at = now_ns_; (at = next_service_ns()) <= now_ns;) {
    next_frame_ = at / frame + 1;
    device_.advance(at);
    serve_frame(at / frame, at);
  }
  device_.advance(now_ns);
  now_ns_ = std::max(now_ns_, now_ns);
  next_frame_ = std::max(next_frame_, first_frame(now_ns_ + 1));
  std::vector<Done> done;
  for (; !done_.empty() && done_.front().at_ns <= now_ns; done_.pop_front())
    done.push_back(std::move(done_.front()));
  return done;
}

std::int64_t Wire::next_ns() const {
  const std::int64_t done_ns = done_.empty() ? kNever : done_.front().at_ns;
  return std::min({done_ns, next_service_ns(), device_.next_ns()});
}

/// Of the first frame in which a transfer that waits is tried.
std::int64_t Wire::next_service_ns() const {
  std::int64_t next_ns = kNever;
  for (const Endpoint& endpoint : endpoints_)
    if (!endpoint.waiting.empty()) next_ns = std::min(next_ns, service_ns(endpoint));
  return next_ns;
}

std::int64_t Wire::service_ns(const Endpoint& endpoint) const {
  const std::int64_t from_ns = std::max(endpoint.waiting.front().since_ns, hangs_until_ns_);
  const std::int64_t frame = std::max(next_frame_, first_frame(from_ns));
  const std::int64_t every = endpoint.every_frames;
  return (frame + every - 1) / every * every * frame_ns();
}

std::int64_t Wire::frame_ns() const {
  return std::llround(1e9 * options_.frame_s / (device_.speed() == Speed::high ? 8 : 1));
}

std::int64_t Wire::first_frame(std::int64_t at_ns) const {
  return at_ns <= 0 ? 0 : (at_ns - 1) / frame_ns() + 1;
}

void Wire::serve_frame(std::int64_t frame, std::int64_t at_ns) {
  if (at_ns < hangs_until_ns_) return;
  for (Endpoint& endpoint : endpoints_)
    if (frame % endpoint.every_frames == 0) serve(endpoint, at_ns);
}

void Wire::serve(Endpoint& endpoint, std::int64_t at_ns) {
  int left = endpoint.bulk ? kBulkPackets[device_.speed() == Speed::high] : 1;
  const bool in = endpoint.address & kIsIn;
  while (left-- > 0 && !endpoint.waiting.empty() && endpoint.waiting.front().since_ns <= at_ns) {
    Transfer& first = endpoint.waiting.front();
    Served served = Served::stalled;
    if (!endpoint.halted)
      served = in ? fetch(endpoint, first, at_ns) : give(endpoint, first, at_ns);
    if (served == Served::later) return;
    if (served == Served::done) complete(endpoint, End::ok, at_ns);
    if (served != Served::stalled) continue;
    endpoint.halted = true;
    while (!endpoint.waiting.empty()) complete(endpoint, End::stalled, at_ns);
  }
}

Wire::Served Wire::give(Endpoint& endpoint, Transfer& transfer, std::int64_t at_ns) {
  const std::size_t size =
      std::min(endpoint.packet_bytes, transfer.bytes.size() - transfer.sent_bytes);
  const auto packet = std::span(transfer.bytes).subspan(transfer.sent_bytes, size);
  const std::uint8_t number = endpoint.address & 15;
  if (befalls(options_.drop)) {
    ++befallen_;
  } else {
    const Answer::Kind kind = device_.out(number, packet, at_ns).kind;
    if (kind == Answer::Kind::nak) return Served::later;
    if (kind == Answer::Kind::stall) return Served::stalled;
    if (befalls(options_.duplicate)) {
      ++befallen_;
      (void)device_.out(number, packet, at_ns);
    }
  }
  transfer.sent_bytes += size;
  return transfer.sent_bytes == transfer.bytes.size() ? Served::done : Served::packet;
}

Wire::Served Wire::fetch(Endpoint& endpoint, Transfer& transfer, std::int64_t at_ns) {
  const std::size_t most =
      std::min(endpoint.packet_bytes, transfer.most_bytes - transfer.bytes.size());
  const bool again = std::exchange(endpoint.comes_again, false);
  Answer answer = again ? Answer{.bytes = std::exchange(endpoint.again, {})}
                        : device_.in(endpoint.address & 15, most, at_ns);
  if (answer.kind == Answer::Kind::nak) return Served::later;
  if (answer.kind == Answer::Kind::stall) return Served::stalled;
  std::vector<std::uint8_t>& packet = answer.bytes;
  packet.resize(std::min(packet.size(), most));
  if (!again && befalls(options_.drop)) {
    ++befallen_;
    return Served::later;
  }
  if (!again) befall(endpoint, packet);
  const bool full = packet.size() == endpoint.packet_bytes;
  if (transfer.bytes.empty())
    transfer.bytes = std::move(packet);
  else
    transfer.bytes.insert(transfer.bytes.end(), packet.begin(), packet.end());
  return full && transfer.bytes.size() < transfer.most_bytes ? Served::packet : Served::done;
}

/// What an IN packet that arrives may suffer.
void Wire::befall(Endpoint& endpoint, std::vector<std::uint8_t>& packet) {
  if (befalls(options_.duplicate)) {
    ++befallen_;
    endpoint.comes_again = true;
    endpoint.again = packet;
  }
  if (!packet.empty() && befalls(options_.runt)) {
    ++befallen_;
    packet.resize(static_cast<std::size_t>(lot() * static_cast<double>(packet.size())));
  }
}

void Wire::complete(Endpoint& endpoint, End end, std::int64_t at_ns) {
  Transfer& first = endpoint.waiting.front();
  const double late_s = options_.jitter_s > 0 ? options_.jitter_s * lot() : 0;
  endpoint.last_done_ns =
      std::max(endpoint.last_done_ns, at_ns + std::int64_t{std::llround(1e9 * late_s)});
  if (end == End::ok) ++carried_;
  Done one{.id = first.id, .end = end, .at_ns = endpoint.last_done_ns};
  if (endpoint.address & kIsIn) one.bytes = std::move(first.bytes);
  endpoint.waiting.pop_front();
  finish(std::move(one));
}

void Wire::finish(Done one) {
  auto at = done_.end();
  while (at != done_.begin() && std::prev(at)->at_ns > one.at_ns) --at;
  done_.insert(at, std::move(one));
}

void Wire::unplug() {
  plugged_ = false;
  configured_ = 0;
  hangs_until_ns_ = INT64_MIN;
  for (Endpoint& endpoint : endpoints_) {
    for (const Transfer& transfer : endpoint.waiting)
      finish({.id = transfer.id, .end = End::gone, .at_ns = std::max(now_ns_, transfer.since_ns)});
    endpoint = {.address = endpoint.address,
                .bulk = endpoint.bulk,
                .packet_bytes = endpoint.packet_bytes,
                .every_frames = endpoint.every_frames};
  }
}

void Wire::plug(bool power_lost, std::int64_t now_ns) {
  plugged_ = true;
  now_ns_ = std::max(now_ns_, now_ns);
  next_frame_ = first_frame(now_ns_ + 1);
  device_.replug(power_lost, now_ns);
}

void Wire::hang(std::int64_t until_ns) {
  hangs_until_ns_ = until_ns;
}

void Wire::stall(std::uint8_t endpoint_address) {
  if (Endpoint* endpoint = find(endpoint_address)) endpoint->halted = true;
}

bool Wire::befalls(double share) {
  return share > 0 && lot() < share;
}

double Wire::lot() {
  return std::ldexp(static_cast<double>(engine_() >> 11), -53);
}

}  // namespace hapticd::sim::usb
