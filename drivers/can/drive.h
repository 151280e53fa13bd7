// One drive as the servo thread speaks to it: what a protocol has to do for the device around it (can_device.h). Set-up
// may wait; all else happens inside a tick: frames go into an outbox that is sent as a whole, frames that came are
// handed in one by one.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "control/core/result.h"
#include "drivers/can/conversation.h"
#include "drivers/can/frame.h"
#include "drivers/can/options.h"
#include "drivers/can/socket.h"
#include "drivers/fault_text.h"

namespace hapticd::can {

using drivers::FaultText;

/// What one tick sends on one bus.
class Outbox {
 public:
  void add(const Frame& frame) noexcept {
    if (size_ < frames_.size()) frames_[size_++] = frame;
  }
  void add(const std::optional<Frame>& frame) noexcept {
    if (frame) add(*frame);
  }
  std::span<const Frame> frames() const noexcept { return {frames_.data(), size_}; }
  void clear() noexcept { size_ = 0; }

 private:
  std::array<Frame, Socket::kMost> frames_{};
  std::size_t size_ = 0;
};

/// What came with a frame.
enum class Heard : std::uint8_t {
  nothing,       ///< not of this drive
  something,     ///< of this drive
  sample,        ///< its position
  other_master,  ///< a command to this drive, from somebody else
};

class Drive {
 public:
  Drive(const DeviceOptions& device, const DriveOptions& options)
      : device_(device), options_(options) {}
  Drive(const Drive&) = delete;
  Drive& operator=(const Drive&) = delete;
  virtual ~Drive() = default;

  // -- set-up
  /// Frames that the drive sends, and those that only another master would send to it.
  virtual std::vector<Filter> filters() const = 0;
  /// Finds the drive, refuses one that is not as it has to be, sets it up, power stage off. What it is, for people.
  virtual Result<std::string> connect(Conversation& conversation) = 0;

  /// Whether it sends what is for all drives of its bus.
  virtual void lead(bool leads) noexcept { (void)leads; }

  // -- loop, in this order in every tick
  void begin_tick(std::int64_t now_ns) noexcept { now_ns_ = now_ns; }
  /// Before the samples: a query, where the timing wants one.
  virtual void query(Outbox& outbox) noexcept = 0;
  virtual Heard take(const Frame& frame, std::int64_t stamp_ns) noexcept = 0;
  /// Torque at the drive [N m]; until it is armed the next step towards that. What the frames carry of it is left in
  /// carried_Nm().
  void act(double torque_Nm, Outbox& outbox) noexcept;
  /// Zero torque and power off by the next frame, whatever it was about to do.
  void stop_now(Outbox& outbox) noexcept;
  /// Whether the bus took what act() had for it. Arming does not go on over a gap, and a torque must not stay for long.
  void sent(bool all) noexcept;

  void set_armed(bool wanted) noexcept;
  bool armed() const noexcept { return armed_; }
  /// Samples say where the axis is.
  bool knows_position() const noexcept { return knows_position_; }
  /// Nothing is asked just now, since the drive must not hear anything.
  bool silent() const noexcept { return silent_; }
  bool failed() const noexcept { return failed_; }
  void clear_failure() noexcept { failed_ = false; }

  double counts() const noexcept { return counts_; }
  std::int64_t stamp_ns() const noexcept { return stamp_ns_; }
  std::uint16_t limits() const noexcept { return limits_; }
  std::uint32_t faults() const noexcept { return faults_; }
  double carried_Nm() const noexcept { return carried_Nm_; }
  /// Torque at the drive for an effort of 1 at the axis: effort x axis = torque x angle.
  double torque_per_effort() const noexcept {
    return options_.counts_per_turn / (2 * std::numbers::pi * options_.counts_per_unit);
  }
  double max_torque_Nm() const noexcept {
    return options_.max_effort * std::abs(torque_per_effort());
  }

  const DriveOptions& options() const noexcept { return options_; }
  /// Where failures are worded.
  void tell(FaultText& text) noexcept { text_ = &text; }
  /// "left.x (node 3 on can0): ".
  FaultText& blame() noexcept;

 protected:
  /// The first failure stands until it is cleared.
  void fail(std::string_view what, std::string_view word = {},
            std::string_view advice = {}) noexcept;
  void measured(double counts, std::int64_t stamp_ns) noexcept {
    counts_ = counts;
    stamp_ns_ = stamp_ns;
  }
  virtual void start_arming() noexcept = 0;
  /// While it is to be armed and nothing has failed.
  virtual void command(double torque_Nm, Outbox& outbox) noexcept = 0;
  /// Power stage off. `must`: the drive is told; else it was told already, and is only asked what the timing wants.
  virtual void stop(bool must, Outbox& outbox) noexcept = 0;

  const DeviceOptions& device_;
  const DriveOptions options_;
  std::int64_t now_ns_ = 0;
  bool arm_wanted_ = false;
  bool armed_ = false;
  /// It restarted: its position may count from elsewhere, and what it was told may be gone. Only connect() ends that.
  bool lost_ = false;
  bool knows_position_ = false;
  bool silent_ = false;
  std::uint16_t limits_ = 0;
  std::uint32_t faults_ = 0;
  double carried_Nm_ = 0;

 private:
  static constexpr int kStops = 5;  ///< frames: a bus may lose one

  bool failed_ = false;
  int stops_left_ = kStops;
  int unsent_ticks_ = 0;
  double counts_ = 0;
  std::int64_t stamp_ns_ = 0;
  FaultText* text_ = nullptr;
};

/// Of a drive that the options name by number: "node 3 on can0".
std::string place_of(const DriveOptions& options);

}  // namespace hapticd::can
