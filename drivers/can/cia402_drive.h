// A CiA 402 drive in cyclic synchronous torque over CANopen: set up by SDOs before the loop runs; in it SYNC, one PDO
// each way, and heartbeats, which the drive watches the host by.
#pragma once
#include "drivers/can/cia402_codec.h"
#include "drivers/can/drive.h"

namespace hapticd::can {

class Cia402Drive final : public Drive {
 public:
  using Drive::Drive;

  std::vector<Filter> filters() const override;
  Result<std::string> connect(Conversation& conversation) override;
  /// SYNC and heartbeat are for all drives of a bus: the first one of a bus sends them.
  void lead(bool leads) noexcept override { leads_ = leads; }
  void query(Outbox& outbox) noexcept override;
  Heard take(const Frame& frame, std::int64_t stamp_ns) noexcept override;

 private:
  void start_arming() noexcept override;
  void command(double torque_Nm, Outbox& outbox) noexcept override;
  void stop(bool must, Outbox& outbox) noexcept override;
  void hear_status(const cia402::Tpdo1& pdo, std::int64_t stamp_ns) noexcept;
  void hear_emergency(const cia402::Emergency& emergency) noexcept;
  void hear_heartbeat(cia402::NodeState state, std::int64_t stamp_ns) noexcept;
  std::uint16_t next_control() noexcept;
  bool running() const noexcept { return state_ == cia402::State::operation_enabled; }

  double rated_Nm_ = 0;
  bool leads_ = true;
  std::int64_t arming_since_ns_ = 0;
  std::int64_t heartbeat_ns_ = 0, sent_heartbeat_ns_ = 0;
  cia402::State state_ = cia402::State::not_ready;
  std::uint16_t control_ = 0;  ///< last sent
};

}  // namespace hapticd::can
