// An ODrive on CANSimple, firmware 0.6, torque mode. What the protocol cannot tell is proved: with no torque the host
// falls silent, and the drive has to go off by its watchdog.
#pragma once
#include "drivers/can/drive.h"
#include "drivers/can/odrive_codec.h"

namespace hapticd::can {

class OdriveDrive final : public Drive {
 public:
  using Drive::Drive;

  std::vector<Filter> filters() const override;
  Result<std::string> connect(Conversation& conversation) override;
  void query(Outbox& outbox) noexcept override;
  Heard take(const Frame& frame, std::int64_t stamp_ns) noexcept override;

 private:
  enum class Stage : std::uint8_t { off, idle, prepare, enter, silence, ask, armed };

  void command(double torque_Nm, Outbox& outbox) noexcept override;
  void stop(bool must, Outbox& outbox) noexcept override;
  void start_arming() noexcept override { go(Stage::idle); }
  void go(Stage stage) noexcept;
  void prepare(Outbox& outbox) noexcept;
  void enter(Outbox& outbox) noexcept;
  void ask(Outbox& outbox) noexcept;
  void drive(double torque_Nm, Outbox& outbox) noexcept;
  void hear(const odrive::Heartbeat& heartbeat, std::int64_t stamp_ns) noexcept;
  /// A heartbeat that was sent after this time, and after what the tick of that time sent.
  bool heard_since(std::int64_t time_ns) const noexcept;
  bool closed_loop() const noexcept;
  std::int64_t heartbeat_limit_ns() const noexcept;

  Result<odrive::Version> find(Conversation& conversation) const;
  Result<void> listen(Conversation& conversation) const;

  Stage stage_ = Stage::off;
  std::int64_t since_ns_ = 0;  ///< in this stage
  int step_ = 0;               ///< of it
  odrive::Heartbeat heartbeat_{};
  std::int64_t heartbeat_ns_ = 0;
  odrive::Errors errors_{};
  std::int64_t errors_ns_ = 0;
  bool watchdog_proved_ = false;
};

}  // namespace hapticd::can
