// A device whose axes are drives on CAN buses, behind drivers/device.h. In a tick each bus gets what the drives ask and
// command in one system call each, and is emptied in one or two; nothing is tried twice.
//
//   request   what came too late for the tick before is counted; questions go out, but not to a drive that still owes an
//             answer: what it then says would be taken for the next one
//   collect   the newest sample of each drive, if it is young enough
//   command   torques, or the next step of arming
//
// A failure stands until the power stages were switched off and nothing is wrong any more; while it stands each tick
// tells the drives to stop. Anybody else who commands a drive is a failure too.
#pragma once
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "drivers/can/drive.h"
#include "drivers/can/host.h"
#include "drivers/can/options.h"
#include "drivers/device.h"

namespace hapticd::can {

class CanDevice final : public drivers::Device {
 public:
  explicit CanDevice(DeviceOptions options, Host& host = this_host());
  ~CanDevice() override;

  /// "can-can0-3": one for each drive.
  std::vector<std::string> lock_names() const override;
  Result<drivers::DeviceInfo> connect() override;
  void disconnect() noexcept override;
  void request(const drivers::TickTime& time) noexcept override;
  drivers::Collected collect(std::span<AxisSample> axes, Aux& aux) noexcept override;
  int wait_fd() const noexcept override { return wait_descriptor_; }
  void command(std::span<const double> effort, std::span<double> delivered) noexcept override;
  void set_armed(bool armed) noexcept override;
  void stop() noexcept override;
  std::string fault_text() const override { return fault_text_.text(); }

  const drivers::Traffic* traffic() const noexcept override { return &traffic_; }

 private:
  /// An axis and what the device knows of its drive.
  struct Axis {
    std::unique_ptr<Drive> drive;
    std::size_t bus = 0;
    bool heard = false;           ///< a sample, in this tick
    bool asked = false;           ///< in phase: its question is out, and no answer has come
    std::int64_t asked_ns = 0;    ///< when the question went out that the newest sample answers
    std::int64_t command_ns = 0;  ///< when the last command went out
    double delivered_Nm = 0;      ///< what the drive was last told
    std::size_t first_frame = 0, frames_end = 0;  ///< its part of this tick's outbox
  };
  struct Bus {
    std::string interface;
    std::vector<std::size_t> axes;  ///< lowest node first
    std::unique_ptr<Socket> socket;
    Outbox outbox;
  };

  void make_axes();
  Result<void> open_buses();
  Result<std::string> connect_drives();
  void make_wait_descriptor();
  void empty(Bus& bus, bool in_time) noexcept;
  void hear(Bus& bus, const Received& received, bool in_time) noexcept;
  void ask(Bus& bus) noexcept;
  bool owed() const noexcept;
  std::int64_t age_ns(const Axis& axis, std::int64_t now_ns) const noexcept;
  void fill(std::span<AxisSample> samples) noexcept;
  void look_for_trouble() noexcept;
  void fail_bus(const Bus& bus, std::string_view what) noexcept;
  void report(Aux& aux) noexcept;
  void let_go() noexcept;
  void command_bus(Bus& bus, std::span<const double> effort, std::span<double> delivered) noexcept;
  void count() noexcept;

  const DeviceOptions options_;
  Host& host_;
  std::vector<Axis> axes_;
  std::vector<Bus> buses_;
  int wait_descriptor_ = -1;
  bool own_wait_descriptor_ = false;
  std::int64_t start_ns_ = 0;  ///< of this tick
  bool arm_wanted_ = false;
  bool bus_failed_ = false;
  bool told_ = false;  ///< a failure, in this tick
  std::int64_t worst_age_ns_ = 0;
  std::uint64_t late_ = 0, foreign_ = 0;
  drivers::Traffic traffic_;
  FaultText fault_text_;
};

}  // namespace hapticd::can
