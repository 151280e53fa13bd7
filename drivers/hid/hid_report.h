// A board of one's own that sends its positions and takes its forces in reports of fixed layout, as the config describes
// them. It sends whenever it likes; what it has to be told is told at least every `every_s`.
#pragma once
#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/hid/report_map.h"
#include "drivers/usb/protocol.h"

namespace hapticd::hid {

class HidReport final : public usb::Protocol {
 public:
  explicit HidReport(const usb::DeviceOptions& options) : Protocol(options) {}

  double carried(std::size_t axis, double effort) const noexcept override;
  usb::Opened<usb::Identity> open(usb::Host& host, usb::Words& words) override;
  usb::Port* port() noexcept override { return found_.port.get(); }
  usb::Heard take(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns,
                  usb::Reading& reading) override;
  usb::Status tell(const usb::Command& command, std::int64_t now_ns) override;
  std::int64_t tell_again_ns(std::int64_t now_ns) const noexcept override {
    return now_ns + std::llround(1e9 * options_.report.every_s);
  }
  void close(usb::Host& host, std::int64_t until_ns) noexcept override;
  std::string_view fault_text() const noexcept override { return fault_; }
  std::uint64_t lost() const noexcept override { return lost_; }
  double round_trip_s() const noexcept override { return round_trip_s_; }

 private:
  usb::Opened<bool> compare();
  usb::Opened<bool> measure(usb::Host& host);
  usb::Opened<bool> measure_reports(usb::Host& host);
  usb::Opened<bool> measure_sending(usb::Host& host);
  void copy(const Reading& from, usb::Reading& to) const;
  Encoded encoded(const usb::Command& command);

  usb::Found<usb::HidPort> found_;
  InputState state_;
  std::uint64_t heartbeat_ = 0;
  std::uint64_t lost_ = 0;  ///< over all connections
  bool armed_ = false;
  double round_trip_s_ = 0;
  std::string_view fault_;
};

}  // namespace hapticd::hid
