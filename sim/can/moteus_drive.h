// A moteus servo, register map version 5.
#pragma once
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "sim/can/drive.h"
#include "sim/can/drive_clock.h"
#include "sim/can/moteus_command.h"
#include "sim/can/moteus_wire.h"

namespace hapticd::sim::can {

struct MoteusOptions {
  std::uint8_t servo = 1;
  std::uint16_t prefix = 0;
  double max_torque_Nm = 10;
  double default_timeout_s = 0.1;                                  ///< NaN: none
  double position_min = std::numeric_limits<double>::quiet_NaN();  ///< turns; NaN: none
  double position_max = std::numeric_limits<double>::quiet_NaN();
  double counts_per_turn = 16384;
  int register_map_version = 5;
  double clock_drift = 0;
  double turnaround_s = 50e-6;
  double calibrating_s = 0.01;  ///< in modes 2, 3, 4, from stopped on
  /// servo.timeout_mode: 0 free; 12 damps, which moves the motor although enabled() is false. The
  /// factory's is 12.
  int timeout_mode = 0;
  std::array<std::uint32_t, 3> serial{0x39713466, 0x30333132, 0x00500041};
};

class MoteusDrive final : public Drive {
 public:
  // Own choice, so that a kp, kd or ilimit scale that the host forgets shows as a torque.
  static constexpr double kKp_Nm = 4;      ///< per turn
  static constexpr double kKd_Nms = 0.05;  ///< per turn/s
  static constexpr double kKi_Nm_s = 1;    ///< per turn
  static constexpr double kIlimit_Nm = 1;
  static constexpr int kOutsideLimit = 39, kPositionInvalid = 43;
  static constexpr int kLimitCurrent = 99, kLimitTorque = 102, kLimitPosition = 103;

  MoteusDrive(const MoteusOptions& options, std::int64_t start_ns);

  void receive(const Frame& frame, std::int64_t now_ns) override;
  void advance(std::int64_t now_ns) override;
  std::int64_t next_ns() const override;
  double torque_Nm() const override { return limited().torque_Nm; }
  /// In modes 10, 12 and 13.
  bool enabled() const override;
  void move_to(double turns, double turns_s) override;
  void reset(std::int64_t now_ns) override;
  /// `code`: as the fault register has it.
  void fail(int code, std::int64_t now_ns) override;
  bool newest_only() const override { return true; }

  MoteusMode mode() const { return mode_; }
  /// Of the fault register: why it is in mode 1, or in a running mode what limits the torque.
  int fault() const;
  const MoteusCommand& command() const { return command_; }

 private:
  struct Limited {
    double torque_Nm = 0;
    int code = 0;
  };
  void run(std::int64_t now_ns);
  std::int64_t mode_end_ns() const;
  void end_mode(std::int64_t now_ns);
  void read(const MoteusBlock& block, std::vector<std::uint8_t>& reply) const;
  bool write(const MoteusBlock& block, std::vector<std::uint8_t>& reply);
  void answer(const Frame& query, const std::vector<std::uint8_t>& reply, std::int64_t now_ns);
  void obey(std::int64_t now_ns);
  void enter(MoteusMode mode, std::int64_t now_ns);
  void aim();
  bool outside() const;
  Limited limited() const;
  double wanted_Nm() const;
  double held_Nm(double target) const;
  double counted_turns() const;
  std::optional<double> value(std::uint32_t reg) const;

  MoteusOptions options_;
  DriveClock clock_;
  MoteusMode mode_ = MoteusMode::stopped;
  MoteusMode target_ = MoteusMode::stopped;  ///< after the calibration
  int fault_ = 0;
  MoteusCommand staged_;   ///< as the registers have it
  MoteusCommand command_;  ///< that is followed
  double setpoint_ = 0;    ///< turns
  double integral_Nm_ = 0;
  std::int64_t boot_ns_ = 0, time_ns_ = 0, entered_ns_ = 0, calibrating_ns_ = 0, commanded_ns_ = 0;
  double turns_ = 0, turns_s_ = 0;
};

}  // namespace hapticd::sim::can
