// Both ends of a bus in a test: the driver's socket, and a plain one for what the driver would never send.
#pragma once
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/can/host.h"
#include "drivers/can/socket.h"

namespace hapticd::test {

inline constexpr std::int64_t kMillisecond = 1'000'000;

inline std::int64_t now_ns() {
  return can::this_host().now_ns();
}
inline void sleep_until(std::int64_t time_ns) {
  const timespec time{.tv_sec = static_cast<time_t>(time_ns / 1'000'000'000),
                      .tv_nsec = static_cast<long>(time_ns % 1'000'000'000)};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) != 0) {
  }
}
inline void pause_ms(int duration_ms) {
  sleep_until(now_ns() + duration_ms * kMillisecond);
}

inline const can::Filter kAllStandard{.id = 0, .mask = 0};
inline const can::Filter kAllExtended{.id = 0, .mask = 0, .extended = true};

inline can::Socket open_socket(const can::SocketOptions& options) {
  auto socket = can::Socket::open(options);
  if (!socket) throw std::runtime_error(socket.error().text);
  return std::move(*socket);
}
/// That hears all frames.
inline can::Socket open_all(const std::string& interface, bool fd = false) {
  return open_socket({.interface = interface, .fd = fd, .filters = {kAllStandard, kAllExtended}});
}
/// Why it cannot be opened; empty: it can.
inline std::string open_error(const can::SocketOptions& options) {
  const auto socket = can::Socket::open(options);
  return socket ? std::string() : socket.error().text;
}

inline can::Frame frame(std::uint32_t id, std::initializer_list<std::uint8_t> data = {}) {
  can::Frame made{};
  made.id = id;
  made.size = static_cast<std::uint8_t>(data.size());
  std::ranges::copy(data, made.data.begin());
  return made;
}

/// What comes until nothing more has come for so long.
inline std::vector<can::Received> hear(can::Socket& socket, int quiet_ms = 20) {
  std::vector<can::Received> all;
  std::int64_t until_ns = now_ns() + quiet_ms * kMillisecond;
  while (now_ns() < until_ns && socket.trouble() < can::Trouble::down) {
    const auto some = socket.receive(now_ns());
    all.insert(all.end(), some.begin(), some.end());
    if (!some.empty()) until_ns = now_ns() + quiet_ms * kMillisecond;
    if (!socket.more()) can::this_host().wait(socket.descriptor(), until_ns);
  }
  return all;
}
inline std::vector<std::uint32_t> ids_of(const std::vector<can::Received>& all) {
  std::vector<std::uint32_t> ids;
  for (const can::Received& one : all) ids.push_back(one.frame.id);
  return ids;
}

/// A socket of another program.
class RawSocket {
 public:
  explicit RawSocket(const std::string& interface, bool fd = false)
      : descriptor_(::socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW)) {
    const int on = fd ? 1 : 0;
    ::setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof on);
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(::if_nametoindex(interface.c_str()));
    if (::bind(descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("no socket on " + interface);
  }
  RawSocket(const RawSocket&) = delete;
  RawSocket& operator=(const RawSocket&) = delete;
  ~RawSocket() { ::close(descriptor_); }

  int descriptor() const { return descriptor_; }
  /// `id` with its flags.
  void send(std::uint32_t id, std::initializer_list<std::uint8_t> data, std::uint8_t flags = 0) {
    canfd_frame sent{};
    sent.can_id = id;
    sent.len = static_cast<std::uint8_t>(data.size());
    sent.flags = flags;
    std::ranges::copy(data, sent.data);
    write(sent);
  }
  void write(const canfd_frame& sent) {
    const std::size_t size = (sent.flags & CANFD_FDF) != 0 ? CANFD_MTU : CAN_MTU;
    if (::write(descriptor_, &sent, size) != static_cast<ssize_t>(size))
      throw std::runtime_error("a frame was not sent");
  }
  /// As a controller would report it.
  void report(std::uint32_t error_class) {
    send(CAN_ERR_FLAG | error_class, {0, 0, 0, 0, 0, 0, 0, 0});
  }
  /// The next frame and how many bytes the kernel had of it; none within 100 ms: 0.
  std::size_t read(canfd_frame& heard) {
    pollfd waiting{.fd = descriptor_, .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, 100) != 1) return 0;
    const ssize_t size = ::read(descriptor_, &heard, sizeof heard);
    return static_cast<std::size_t>(std::max<ssize_t>(size, 0));
  }

 private:
  int descriptor_;
};

}  // namespace hapticd::test
