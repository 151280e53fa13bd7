// A moteus servo: each frame is the whole command, torque alone, with its watchdog in it, and asks for the state. Every
// question looks a little different, so that a reply shows which one it answers.
#pragma once
#include "drivers/can/drive.h"
#include "drivers/can/moteus_codec.h"

namespace hapticd::can {

class MoteusDrive final : public Drive {
 public:
  MoteusDrive(const DeviceOptions& device, const DriveOptions& options);

  std::vector<Filter> filters() const override;
  Result<std::string> connect(Conversation& conversation) override;
  void query(Outbox& outbox) noexcept override;
  Heard take(const Frame& frame, std::int64_t stamp_ns) noexcept override;

 private:
  enum class Stage : std::uint8_t { off, stopping, starting, armed };

  void command(double torque_Nm, Outbox& outbox) noexcept override;
  void stop(bool must, Outbox& outbox) noexcept override;
  void start_arming() noexcept override { go(Stage::stopping); }
  void go(Stage stage) noexcept;
  bool of_another_master(const Frame& frame) const noexcept;
  void hear(const moteus::Reply& reply) noexcept;
  void watch_time(const moteus::Reply& reply) noexcept;
  void hear_starting(const moteus::Reply& reply) noexcept;
  /// No torque yet, and the settings are asked for.
  void start(Outbox& outbox) noexcept;
  void torque(double torque_Nm, Outbox& outbox) noexcept;
  bool in_phase() const noexcept { return device_.timing == drivers::Timing::in_phase; }
  moteus::Query next_query() noexcept;
  std::optional<moteus::Query> query_with_command() noexcept;
  moteus::TorqueCommand settings() const noexcept;

  const moteus::Address address_;
  Stage stage_ = Stage::off;
  std::int64_t since_ns_ = 0;  ///< in this stage
  int tag_ = 0;                ///< of the last question
  int mode_ = -1;              ///< as last heard
  bool asks_time_ = false;     ///< the last question does, in full
  std::uint32_t up_ms_ = 0;    ///< the servo's own time when it was last asked for
  std::int64_t up_at_ns_ = 0;
  std::int64_t heard_ns_ = 0;
  const moteus::TorqueCommands commands_;
};

}  // namespace hapticd::can
