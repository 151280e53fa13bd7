// A device on USB behind drivers/device.h. The servo thread makes no USB call: it reads the newest reading from a slot and
// fills one with the newest command; the device's own thread (worker.h) does the rest, and may wait.
//
// A device may come and go while the loop runs. One that goes away is a failure, which stands until the power stages were
// switched off and the device is there again; the first sample of every connection is marked as such (Freshness::first).
#pragma once
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/device.h"
#include "drivers/usb/exchange.h"
#include "drivers/usb/host.h"
#include "drivers/usb/protocol.h"
#include "drivers/usb/runner.h"
#include "drivers/usb/worker.h"

namespace hapticd::usb {

class UsbDevice final : public drivers::Device {
 public:
  UsbDevice(DeviceOptions options, std::unique_ptr<Host> host, std::unique_ptr<Runner> runner);
  ~UsbDevice() override;

  /// "usb-0403-cb48" and what else the config says of which one is meant.
  std::vector<std::string> lock_names() const override;
  /// A device that is not plugged in is waited for while the loop runs; one that is and cannot be used is an error.
  Result<drivers::DeviceInfo> connect() override;
  void disconnect() noexcept override;
  void request(const drivers::TickTime& time) noexcept override;
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override;
  void command(std::span<const double> effort, std::span<double> delivered) noexcept override;
  void set_armed(bool armed) noexcept override { arm_wanted_ = armed; }
  void stop() noexcept override;
  std::string fault_text() const override { return exchange_.lost.text(); }
  std::string status_text() const override;
  const drivers::Traffic* traffic() const noexcept override { return &exchange_.traffic; }

 private:
  void look_at_link() noexcept;
  void fill(std::span<AxisSample> axes, Aux& aux) noexcept;
  void give(const Command& command) noexcept;

  const DeviceOptions options_;
  std::unique_ptr<Host> host_;
  std::unique_ptr<Runner> runner_;
  std::unique_ptr<Protocol> protocol_;
  Exchange exchange_;
  std::unique_ptr<Worker> worker_;

  // the servo thread's
  Reading reading_{};
  std::uint32_t link_ = 0;      ///< that it has seen; 0: none yet
  std::uint32_t failures_ = 0;  ///< of this connection, that were seen
  bool begun_ = false;          ///< a sample of this connection was handed on
  bool arm_wanted_ = false;
  bool armed_ = false;
  bool failed_ = false;
  bool told_ = false;  ///< a failure, in a tick
};

}  // namespace hapticd::usb
