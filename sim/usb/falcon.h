// Novint Falcon: bridge and board in one housing.
#pragma once
#include <cstdint>
#include <string>

#include "sim/usb/device.h"
#include "sim/usb/falcon_board.h"
#include "sim/usb/ftdi_bridge.h"

namespace hapticd::sim::usb {

struct FalconOptions {
  std::uint16_t vendor = 0x0403, product = 0xcb48;
  std::string serial = "FALCON01";
  FtdiOptions bridge{};
  FalconBoardOptions board{};
};

/// Motors: encoder counts of the three legs, from their zero; torque of a leg [N m]. The counts that it reports start at
/// power-up, until it is homed.
class Falcon final : public Device {
 public:
  static constexpr std::uint8_t kIn = 1, kOut = 2;

  explicit Falcon(const FalconOptions& options);

  std::vector<std::uint8_t> device_descriptor() const override;
  std::vector<std::uint8_t> configuration_descriptor() const override;
  Names names() const override;
  std::vector<std::uint8_t> report_descriptor(int) const override { return {}; }

  Answer control(const Setup& setup, std::span<const std::uint8_t> data,
                 std::int64_t now_ns) override;
  Answer out(std::uint8_t endpoint, std::span<const std::uint8_t> bytes,
             std::int64_t now_ns) override;
  Answer in(std::uint8_t endpoint, std::size_t most_bytes, std::int64_t now_ns) override;
  void advance(std::int64_t now_ns) override { board_.advance(now_ns); }
  std::int64_t next_ns() const override { return board_.next_ns(); }
  void replug(bool power_lost, std::int64_t now_ns) override;
  std::size_t motors() const override { return 3; }
  Motor& motor(std::size_t i) override { return board_.leg(i); }

  FalconBoard& board() { return board_; }
  const FtdiBridge& bridge() const { return bridge_; }

 private:
  FalconOptions options_;
  FtdiBridge bridge_;
  FalconBoard board_;
};

}  // namespace hapticd::sim::usb
