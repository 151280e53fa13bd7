// An ODrive of firmware 0.6 behind CANSimple. Where the facts leave it open, it behaves as is worst
// for the host: only Set_Input_* feeds the watchdog, an old torque stays over a disarm, and states
// other than idle and closed loop are ignored.
#pragma once
#include <array>
#include <cstdint>

#include "sim/can/drive.h"
#include "sim/can/drive_clock.h"
#include "sim/can/odrive_wire.h"

namespace hapticd::sim::can {

struct OdriveOptions {
  std::uint8_t node = 0;
  double max_torque_Nm = 10;
  double watchdog_s = 0.02;
  bool watchdog_enabled = true;
  double estimates_every_s = 0.001;  ///< 0: only when asked
  double heartbeat_every_s = 0.1;    ///< 0: never
  double counts_per_turn = 16384;
  std::array<std::uint8_t, 3> firmware{0, 6, 11};
  std::uint8_t protocol = 2;
  double clock_drift = 0;
  double start_phase_s = 0;  ///< of the cyclic messages: the first ones come so long after boot
  double turnaround_s = 50e-6;
  std::uint64_t serial = 0x3971'3466'3033;  ///< 48 bits
  bool zero_until_closed_loop = true;       ///< estimates are 0, 0 before the first closed loop
  bool heartbeat_on_change = false;         ///< also one as soon as state or errors change
};

class OdriveDrive final : public Drive {
 public:
  static constexpr std::uint8_t kIdle = 1, kClosedLoop = 8;
  static constexpr std::uint32_t kMissingInput = 1U << 6, kWatchdogExpired = 1U << 24,
                                 kEstopRequested = 1U << 25;

  OdriveDrive(const OdriveOptions& options, std::int64_t start_ns);

  void receive(const Frame& frame, std::int64_t now_ns) override;
  void advance(std::int64_t now_ns) override;
  std::int64_t next_ns() const override;
  double torque_Nm() const override;
  bool enabled() const override { return state_ == kClosedLoop && follows_torque(); }
  void move_to(double turns, double turns_s) override;
  void reset(std::int64_t now_ns) override;
  /// `code`: bits of the error.
  void fail(int code, std::int64_t now_ns) override;

  std::uint8_t node() const { return node_; }
  std::uint8_t state() const { return state_; }
  std::uint32_t errors() const { return errors_; }
  std::uint32_t disarm_reason() const { return disarm_reason_; }
  const OdriveSetControllerMode& mode() const { return mode_; }
  const OdriveSetLimits& limits() const { return limits_; }

 private:
  void obey(const OdriveSetAxisState& order, std::int64_t now_ns);
  void obey(const OdriveSetControllerMode& order, std::int64_t now_ns);
  void obey(const OdriveSetInputPos& order, std::int64_t now_ns);
  void obey(const OdriveSetInputVel& order, std::int64_t now_ns);
  void obey(const OdriveSetInputTorque& order, std::int64_t now_ns);
  void obey(const OdriveSetLimits& order, std::int64_t now_ns);
  void obey(const OdriveClearErrors& order, std::int64_t now_ns);
  void obey(const OdriveEstop& order, std::int64_t now_ns);
  void obey(const OdriveReboot& order, std::int64_t now_ns);
  void obey(const OdriveSetAddress& order, std::int64_t now_ns);
  void obey(const OdriveAsk& order, std::int64_t now_ns);
  void disarm(std::uint32_t errors, std::int64_t now_ns);
  void changed(std::int64_t now_ns);
  bool follows_torque() const { return mode_.control == 1 && mode_.input == 1; }
  std::int64_t watchdog_ns() const;
  Frame message(OdriveCommand what) const;
  Frame estimates() const;

  OdriveOptions options_;
  DriveClock clock_;
  std::uint8_t node_;
  Cycle heartbeats_, estimates_;
  std::uint8_t state_ = kIdle;
  std::uint8_t result_ = 0;
  std::uint32_t errors_ = 0, disarm_reason_ = 0;
  OdriveSetControllerMode mode_{3, 1};
  OdriveSetLimits limits_{};
  double input_Nm_ = 0;
  std::int64_t fed_ns_ = 0;
  bool was_closed_loop_ = false;
  double turns_ = 0, turns_s_ = 0;
};

}  // namespace hapticd::sim::can
