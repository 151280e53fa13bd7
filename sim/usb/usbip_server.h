// The emulated device's end of a USB/IP connection, as Linux' virtual host controller has the other: takes the host's
// transfers off a stream, gives them to a Wire and sends back how they ended. No thread, no clock, never blocks.
#pragma once
#include <cstdint>
#include <span>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "sim/usb/control_queue.h"
#include "sim/usb/usbip.h"
#include "sim/usb/wire.h"

namespace hapticd::sim::usb {

class UsbipServer {
 public:
  /// More transfers at a time are refused.
  static constexpr std::size_t kMostPending = 1024;

  /// `fd`: one end of a SOCK_STREAM pair; is closed here, which for the host is unplugging. `device`: as it was attached.
  UsbipServer(Wire& wire, int fd, std::uint32_t device);
  UsbipServer(const UsbipServer&) = delete;
  UsbipServer& operator=(const UsbipServer&) = delete;
  ~UsbipServer();

  /// Takes what the host sent as sent now, runs the wire up to now, sends what is done. False: the connection is over.
  bool advance(std::int64_t now_ns);
  /// When something happens without news from the host.
  std::int64_t next_ns() const;
  int fd() const { return fd_; }  ///< to wait on; -1: over
  bool wants_to_write() const { return !out_.empty(); }
  /// Why it is over; empty: it is not.
  std::string_view over() const { return over_; }
  std::size_t pending() const { return pending_.size(); }  ///< transfers that the host waits for

 private:
  struct Pending {
    std::uint8_t endpoint = 0;
    bool in = false;
    std::uint32_t length = 0;
  };

  void end(std::string_view why);
  void hear(std::int64_t now_ns);
  void take_requests(std::int64_t now_ns);
  void take(const usbip::Request& request, std::span<const std::uint8_t> payload,
            std::int64_t now_ns);
  void submit(const usbip::Request& request, std::span<const std::uint8_t> payload,
              std::int64_t now_ns);
  void unlink(const usbip::Request& request);
  void run(std::int64_t now_ns);
  void finish(const Wire::Done& done);
  void say(const usbip::Reply& reply, std::span<const std::uint8_t> payload = {});
  void send_out();

  Wire& wire_;
  int fd_;
  std::uint32_t device_;
  ControlQueue controls_;
  std::unordered_map<std::uint64_t, Pending> pending_;
  std::vector<std::uint8_t> heard_,
      out_;  ///< what has no end yet; what the socket has not taken yet
  std::string_view over_{};
};

}  // namespace hapticd::sim::usb
