#include "sim/usb/control_queue.h"

#include <algorithm>

namespace hapticd::sim::usb {
namespace {

constexpr std::int64_t kAskAgain_ns = 1'000'000;  // a frame
constexpr std::uint8_t kToHost = 0x80;

/// What no host sends is refused here: data that are not those which the request announces.
Answer ask(Wire& wire, const Setup& setup, std::span<const std::uint8_t> data,
           std::int64_t now_ns) {
  const bool to_host = (setup.request_type & kToHost) != 0;
  if (data.size() != (to_host ? 0 : setup.length)) return {.kind = Answer::Kind::stall};
  Answer answer = wire.control(setup, data, now_ns);
  answer.bytes.resize(std::min<std::size_t>(answer.bytes.size(), to_host ? setup.length : 0));
  return answer;
}

}  // namespace

void ControlQueue::add(std::uint64_t id, const Setup& setup, std::span<const std::uint8_t> data) {
  if (waiting_.empty()) again_ns_ = 0;
  waiting_.push_back({id, setup, {data.begin(), data.end()}});
}

bool ControlQueue::cancel(std::uint64_t id) {
  return std::erase_if(waiting_, [id](const Waiting& one) { return one.id == id; }) > 0;
}

std::vector<Wire::Done> ControlQueue::advance(Wire& wire, std::int64_t now_ns) {
  std::vector<Wire::Done> done;
  for (; !waiting_.empty(); waiting_.pop_front()) {
    const Waiting& first = waiting_.front();
    Wire::Done one{.id = first.id, .end = End::gone, .at_ns = now_ns};
    if (wire.plugged()) {
      if (now_ns < again_ns_) break;
      Answer answer = ask(wire, first.setup, first.data, now_ns);
      again_ns_ = answer.kind == Answer::Kind::nak ? now_ns + kAskAgain_ns : 0;
      if (answer.kind == Answer::Kind::nak) break;
      one.end = answer.kind == Answer::Kind::ack ? End::ok : End::stalled;
      one.bytes = std::move(answer.bytes);
    }
    done.push_back(std::move(one));
  }
  return done;
}

std::int64_t ControlQueue::next_ns() const {
  return waiting_.empty() ? kNever : again_ns_;
}

}  // namespace hapticd::sim::usb
