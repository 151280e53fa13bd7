#include "sim/can/emulated_bus.h"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "sim/can/bus_time.h"

namespace hapticd::sim::can {

EmulatedBus::EmulatedBus(int fd, const WireOptions& options)
    : fd_(fd), options_(options), engine_(options.seed) {}

void EmulatedBus::advance(std::int64_t now_ns) {
  run_until(now_ns);
  hear_host(now_ns);
  run_until(now_ns);
}

std::int64_t EmulatedBus::next_ns() const {
  std::int64_t next = on_bus_ ? on_bus_->at_ns : next_start_ns();
  for (const Drive* drive : drives_) next = std::min(next, drive->next_ns());
  for (const Timed& frame : injected_) next = std::min(next, frame.at_ns);
  if (!due_.empty()) next = std::min(next, due_.front().at_ns);
  return std::max(next, time_ns_);
}

// -- from the host

void EmulatedBus::hear_host(std::int64_t now_ns) {
  std::array<std::uint8_t, 2 * CANFD_MTU> bytes{};  // longer than any, so that too long shows
  while (true) {
    const ssize_t size = recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size < 0 && errno == EINTR) continue;
    if (size <= 0) return;
    Frame frame{};
    if (size != CAN_MTU && size != CANFD_MTU) {
      ++refused_;
      continue;
    }
    std::memcpy(&frame, bytes.data(), static_cast<std::size_t>(size));
    const auto speed = static_cast<std::uint8_t>(frame.flags & CANFD_BRS);
    frame.flags = size == CANFD_MTU ? static_cast<std::uint8_t>(CANFD_FDF | speed) : 0;
    accept(frame, now_ns);
  }
}

void EmulatedBus::accept(const Frame& frame, std::int64_t now_ns) {
  if (!is_sendable(frame)) {
    ++refused_;
    return;
  }
  std::int64_t at_ns = now_ns + adapter_ns();
  if (!host_.empty()) at_ns = std::max(at_ns, host_.back().at_ns);
  host_.push_back({at_ns, frame, nullptr});
}

// -- in the order of time

void EmulatedBus::run_until(std::int64_t now_ns) {
  collect_sent();
  for (std::int64_t next = next_ns(); next <= now_ns; next = next_ns()) step(next);
  advance_drives(now_ns);
  time_ns_ = std::max(time_ns_, now_ns);
}

void EmulatedBus::step(std::int64_t at_ns) {
  time_ns_ = std::max(time_ns_, at_ns);
  advance_drives(at_ns);
  if (on_bus_ && on_bus_->at_ns <= at_ns) end_frame(at_ns);
  collect_sent();
  if (!on_bus_ && next_start_ns() <= at_ns) start_frame(at_ns);
  give_due(at_ns);
}

void EmulatedBus::advance_drives(std::int64_t at_ns) {
  for (Drive* drive : drives_) drive->advance(at_ns);
  collect_sent();
}

void EmulatedBus::collect_sent() {
  for (Drive* drive : drives_) {
    for (const Drive::Outgoing& sent : drive->take_sent()) {
      if (drive->newest_only())
        std::erase_if(waiting_, [&](const Waiting& older) { return older.from == drive; });
      waiting_.push_back({sent.at_ns, sent.frame, drive});
    }
  }
}

// -- the bus

std::int64_t EmulatedBus::next_start_ns() const {
  std::int64_t next = host_.empty() ? kNever : host_.front().at_ns;
  for (const Waiting& frame : waiting_) next = std::min(next, frame.at_ns);
  return std::max(next, time_ns_);
}

void EmulatedBus::start_frame(std::int64_t at_ns) {
  auto first = waiting_.end();
  for (auto it = waiting_.begin(); it != waiting_.end(); ++it) {
    if (it->at_ns > at_ns) continue;
    if (first == waiting_.end() || arbitration_key(it->frame) < arbitration_key(first->frame))
      first = it;
  }
  const bool host_waits = !host_.empty() && host_.front().at_ns <= at_ns;
  if (host_waits && (first == waiting_.end() ||
                     arbitration_key(host_.front().frame) <= arbitration_key(first->frame))) {
    on_bus_ = host_.front();
    host_.pop_front();
  } else {
    on_bus_ = *first;
    waiting_.erase(first);
  }
  on_bus_->at_ns = at_ns + bus_time_ns(on_bus_->frame, {options_.nominal_Hz, options_.data_Hz});
}

void EmulatedBus::end_frame(std::int64_t at_ns) {
  const Waiting sent = *std::exchange(on_bus_, std::nullopt);
  if (sent.from != nullptr) {
    to_drives(sent, at_ns);
    to_host(sent.frame, at_ns);
    return;
  }
  ++received_;
  if (happens(options_.loss)) return;
  to_drives(sent, at_ns);
  if (happens(options_.duplicate)) to_drives(sent, at_ns);
}

void EmulatedBus::to_drives(const Waiting& sent, std::int64_t at_ns) {
  for (Drive* drive : drives_)
    if (drive != sent.from) drive->receive(sent.frame, at_ns);
}

// -- to the host

void EmulatedBus::to_host(const Frame& frame, std::int64_t at_ns) {
  if (to_lose_ > 0) {
    --to_lose_;
    return;
  }
  if (happens(options_.loss)) return;
  if (reorder_ && !held_back_) {
    held_back_ = frame;
    return;
  }
  queue_to_host(frame, at_ns);
  if (happens(options_.duplicate)) queue_to_host(frame, at_ns);
  if (!held_back_) return;
  queue_to_host(*held_back_, at_ns);
  held_back_.reset();
  reorder_ = false;
}

void EmulatedBus::queue_to_host(const Frame& frame, std::int64_t at_ns) {
  std::int64_t due_ns = at_ns + adapter_ns();
  if (!due_.empty()) due_ns = std::max(due_ns, due_.back().at_ns);
  due_.push_back({due_ns, frame});
}

void EmulatedBus::give_due(std::int64_t at_ns) {
  for (auto it = injected_.begin(); it != injected_.end();) {
    if (it->at_ns > at_ns) {
      ++it;
      continue;
    }
    give(it->frame);
    it = injected_.erase(it);
  }
  for (; !due_.empty() && due_.front().at_ns <= at_ns; due_.pop_front()) give(due_.front().frame);
}

void EmulatedBus::give(const Frame& frame) {
  const std::size_t size = is_fd(frame) ? CANFD_MTU : CAN_MTU;
  const ssize_t written = ::send(fd_, &frame, size, MSG_DONTWAIT | MSG_NOSIGNAL);
  ++(written == static_cast<ssize_t>(size) ? sent_ : dropped_);
}

double EmulatedBus::uniform() {
  return static_cast<double>(engine_() >> 11) * 0x1p-53;
}

std::int64_t EmulatedBus::adapter_ns() {
  const double jitter_s = options_.jitter_s > 0 ? options_.jitter_s * uniform() : 0;
  return std::llround(1e9 * (options_.delay_s + jitter_s));
}

}  // namespace hapticd::sim::can
