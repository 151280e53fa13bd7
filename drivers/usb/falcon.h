// The Novint Falcon: firmware where it is needed, zeros found by its user's hand, packets both ways.
//
// Its lights: red until the grip was pulled out and pushed in (the zeros are not known), blue without force, green with.
// The grip's buttons are digital inputs 0 to 3: plus, forward, centre, minus. The device answers every packet, and is
// therefore told something all the time.
#pragma once
#include <optional>

#include "drivers/usb/falcon_codec.h"
#include "drivers/usb/firmware.h"
#include "drivers/usb/protocol.h"

namespace hapticd::usb {

class Falcon final : public Protocol {
 public:
  explicit Falcon(const DeviceOptions& options) : Protocol(options) {}

  double carried(std::size_t axis, double effort) const noexcept override;
  Opened<Identity> open(Host& host, Words& words) override;
  Port* port() noexcept override { return found_.port.get(); }
  Heard take(std::span<const std::uint8_t> bytes, std::int64_t stamp_ns, Reading& reading) override;
  Status tell(const Command& command, std::int64_t now_ns) override;
  std::int64_t tell_again_ns(std::int64_t now_ns) const noexcept override {
    return now_ns + 2'000'000;
  }
  void close(Host& host, std::int64_t until_ns) noexcept override;
  double round_trip_s() const noexcept override { return round_trip_s_; }

 private:
  double motor_counts(double effort_Nm) const noexcept;
  Opened<bool> read_file();
  Opened<bool> set_up(Host& host, Words& words);
  Opened<bool> load(Host& host, Words& words);
  Opened<bool> measure(Host& host, Words& words);
  bool answers(Host& host);
  std::optional<std::int64_t> exchange_once(Host& host);
  Status send(const Command& command);

  std::optional<falcon::Firmware> firmware_;
  Found<BulkPort> found_;
  falcon::Receiver receiver_;
  std::uint8_t homed_ = 0;
  bool armed_ = false;
  bool gone_ = false;  ///< while it is set up
  double round_trip_s_ = 0;
};

}  // namespace hapticd::usb
