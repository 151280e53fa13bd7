// FTDI's USB to serial bridge, FT232BM: two bulk endpoints, requests, buffers, latency timer, and a line of 8N1.
#pragma once
#include <cstdint>
#include <deque>
#include <span>

#include "sim/usb/device.h"

namespace hapticd::sim::usb {

struct FtdiOptions {
  bool idle_packets =
      true;  ///< two status bytes at each end of the latency timer, also without data
  bool acts_on_event_char = false;  ///< what is there goes out when the character comes
};

/// [baud] of request 3. `value` and `index` as the request has them.
double ftdi_baud(std::uint16_t value, std::uint16_t index);

/// Ends of a line understand each other if their rates differ by less than half a bit in a byte.
inline bool same_baud(double a, double b) {
  return a > 0 && b > 0 && a < 1.04 * b && b < 1.04 * a;
}
/// What the other end of a line reads at another rate.
inline std::uint8_t garbled(std::uint8_t value) {
  return static_cast<std::uint8_t>(0x80 | (value * 37 + 11));
}

class FtdiBridge {
 public:
  static constexpr std::size_t kPacketBytes = 64, kStatusBytes = 2;
  static constexpr std::size_t kToLineBytes = 128, kToHostBytes = 384;

  struct LineByte {
    std::int64_t at_ns = 0;  ///< its stop bit has passed
    std::uint8_t value = 0;
    double baud = 0;
  };

  explicit FtdiBridge(const FtdiOptions& options) : options_(options) {}

  // -- host
  Answer request(const Setup& setup, std::int64_t now_ns);
  Answer out(std::span<const std::uint8_t> bytes, std::int64_t now_ns);
  Answer in(std::size_t most_bytes, std::int64_t now_ns);

  // -- line
  /// The next byte that has left by `now_ns`; false: none.
  bool next_from_host(std::int64_t now_ns, LineByte& byte);
  /// A byte of the other side: its start bit goes out at `start_ns`, or when the one before has passed.
  void from_line(std::uint8_t value, double baud, std::int64_t start_ns);
  bool dtr() const { return dtr_; }
  bool rts() const { return rts_; }
  double baud() const { return baud_; }
  /// Since it was asked last.
  bool take_purged();
  bool take_baud_set();
  /// When the last byte that waits has left; kNever: none waits.
  std::int64_t line_idle_ns() const { return to_line_.empty() ? kNever : to_line_.back().at_ns; }

  void power_up(std::int64_t now_ns);  ///< as the chip is after plugging in

 private:
  Answer set(const Setup& setup, std::int64_t now_ns);
  void reset(std::uint16_t value, std::int64_t now_ns);
  void set_pins(std::uint16_t value);
  void take_arrived(std::int64_t now_ns);

  FtdiOptions options_;
  std::deque<LineByte> to_line_, coming_;
  std::deque<std::uint8_t> to_host_;
  double baud_ = 9600;
  bool eight_n_one_ = true;
  bool dtr_ = true, rts_ = true;
  bool purged_ = false, baud_set_ = false;
  bool overrun_ = false, flush_ = false;
  int event_char_ = -1;
  std::int64_t latency_ns_ = 16'000'000, last_packet_ns_ = 0;
};

}  // namespace hapticd::sim::usb
