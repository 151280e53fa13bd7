// A CiA 402 servo drive over classic CANopen, in cyclic synchronous torque mode.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "sim/can/cia402_objects.h"
#include "sim/can/cia402_wire.h"
#include "sim/can/drive.h"
#include "sim/can/drive_clock.h"

namespace hapticd::sim::can {

struct Cia402Options {
  std::uint8_t node = 1;
  double rated_torque_Nm = 1;
  double max_torque_Nm = 3;  ///< beyond it the target is clipped: status bit 11
  double counts_per_rev = 65536;
  bool supports_cst = true;
  double heartbeat_every_s = 0;  ///< until 0x1017 is written; 0: none
  double clock_drift = 0;
  double turnaround_s = 100e-6;
  double sdo_delay_s = 0.002;
  std::uint32_t device_type = 0x00020192;
  std::uint32_t vendor = 0x0000fade;
  std::uint32_t product = 0x0402;
  std::uint32_t revision = 0x00010000;
  std::uint32_t serial = 4711;
  /// Loss of the host's heartbeat also leads to NMT pre-operational, as is CiA 301's default.
  bool pre_operational_on_loss = false;
};

class Cia402Drive final : public Drive {
 public:
  static constexpr std::uint16_t kHeartbeatLost = 0x8130;

  Cia402Drive(const Cia402Options& options, std::int64_t start_ns);

  void receive(const Frame& frame, std::int64_t now_ns) override;
  void advance(std::int64_t now_ns) override;
  std::int64_t next_ns() const override;
  double torque_Nm() const override { return enabled() ? clipped_Nm() : 0; }
  /// Operation enabled, NMT operational and mode 10.
  bool enabled() const override;
  void move_to(double turns, double turns_s) override;
  void reset(std::int64_t now_ns) override;
  /// `code`: as in 0x603F and EMCY.
  void fail(int code, std::int64_t now_ns) override;

  Cia402State state() const { return state_; }
  NmtState nmt() const { return nmt_; }
  std::uint16_t statusword() const;
  const Cia402Objects& objects() const { return objects_; }

 private:
  void add_objects();
  void add_motion_objects();
  void boot(std::int64_t now_ns);
  void boot_communication(std::int64_t now_ns);
  void obey_nmt(NmtCommand command, std::int64_t now_ns);
  void set_nmt(NmtState state);
  void serve(const SdoRequest& request, std::int64_t now_ns);
  Frame sdo_answer(const SdoRequest& request, std::int64_t now_ns);
  std::uint32_t value_problem(std::uint32_t key, std::uint32_t value) const;
  void write(std::uint32_t key, std::uint32_t value, std::int64_t now_ns);
  void control(std::uint16_t word, std::int64_t now_ns);
  void hear_heartbeat(const Frame& frame, std::int64_t now_ns);
  void hear_rpdo(const Frame& frame, std::int64_t now_ns);
  void take_rpdo(std::uint32_t pdo, const Frame& frame, std::int64_t now_ns);
  void sync(std::int64_t now_ns);
  void send_tpdos(std::int64_t now_ns);
  void lose_host(std::int64_t now_ns);
  std::int64_t host_lost_ns() const;
  void emergency(std::uint16_t code, std::int64_t now_ns);
  void refresh();
  double target_Nm() const;
  double most_Nm() const;
  double clipped_Nm() const;

  Cia402Options options_;
  DriveClock clock_;
  Cia402Objects objects_;
  NmtState nmt_ = NmtState::boot_up;
  Cia402State state_ = Cia402State::switch_on_disabled;
  std::uint16_t last_control_ = 0;
  std::uint16_t error_code_ = 0;
  Cycle heartbeats_;
  std::optional<std::int64_t> heard_host_ns_;  ///< its heartbeat, while it is waited for
  std::int64_t sdo_free_ns_ = 0;
  std::uint32_t syncs_ = 0;
  std::array<std::optional<Frame>, Cia402Objects::kPdos> held_rpdos_;  ///< until the next SYNC
  double turns_ = 0, turns_s_ = 0;
};

}  // namespace hapticd::sim::can
