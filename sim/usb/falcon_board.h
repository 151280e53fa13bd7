// The Falcon behind its bridge: boot ROM, firmware, motors. It knows bytes and pins, not USB.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sim/motor.h"
#include "sim/usb/falcon_wire.h"
#include "sim/usb/ftdi_bridge.h"

namespace hapticd::sim::usb {

/// Bytes without meaning, the same each time: an image to upload.
std::vector<std::uint8_t> made_up_firmware(std::size_t bytes = 7914);

struct FalconBoardOptions {
  std::vector<std::uint8_t> firmware =
      made_up_firmware();  ///< runs exactly this, when uploaded whole
  bool loaded = false;     ///< has it since before it was plugged in
  double torque_per_command_Nm = -1e-4;
  double silence_s =
      0;  ///< motors off without a command for so long; 0: never, they hold the last one
  double stale_s =
      0;  ///< answers no more after so long without one, until purge and baud rate come anew; 0: never
  double home_after_s = -1;  ///< homes itself when told to home for so long; < 0: only with home()

  // -- faults
  int wrong_echo_chunk =
      -1;  ///< the echo of this chunk of 62 bytes is wrong, and it is stored wrong,
  int wrong_echo_times = 0;      ///< in so many uploads
  double dies_at = 2;            ///< share of the upload after which it is silent,
  int deaths = 1;                ///< so many times; the boot sequence wakes it
  int deaf_greetings = 0;        ///< ignores the first so many
  bool leading_zero = false;     ///< 00 before the answer to the greeting
  bool frozen_encoders = false;  ///< they stay where they were at the end of the upload
};

class FalconBoard {
 public:
  static constexpr double kRomBaud = 9600, kLoaderBaud = 3e6 / 21, kRunBaud = 1.5e6;

  class Leg final : public Motor {
   public:
    double torque() const override { return enabled_ ? torque_Nm_ : 0; }
    bool enabled() const override { return enabled_; }
    void move_to(double counts, double) override {
      counts_ = counts;
      if (!placed_) zero_counts_ = frozen_counts_ = counts;  // there it stood at power-up
      placed_ = true;
    }

   private:
    friend class FalconBoard;
    double counts_ = 0, torque_Nm_ = 0, zero_counts_ = 0, frozen_counts_ = 0;
    bool enabled_ = false, placed_ = false;
  };

  FalconBoard(const FalconBoardOptions& options, FtdiBridge& bridge);

  void advance(std::int64_t now_ns);  ///< takes what came over the line by then
  std::int64_t next_ns() const;       ///< of its timers
  void power_up(std::int64_t now_ns);
  void bridge_reset();  ///< unplugged and back, the mains stayed on

  /// The grip was pulled out and pushed in: sets the bits, if told to home. False: it is not.
  bool home(std::uint8_t mask);
  void set_grip(std::uint8_t buttons) { grip_ = buttons; }
  bool firmware_runs() const { return mode_ == Mode::running; }
  /// Of the firmware that is being uploaded; nothing: none is.
  std::optional<double> loaded_share() const {
    if (mode_ != Mode::loading) return std::nullopt;
    return static_cast<double>(uploaded_) / static_cast<double>(options_.firmware.size());
  }
  bool stale() const { return stale_; }
  const FalconCommand& last_command() const { return command_; }
  std::uint64_t commands() const { return commands_; }
  std::uint8_t homed() const { return homed_; }
  Leg& leg(std::size_t i) { return legs_[i]; }

 private:
  enum class Mode : std::uint8_t { asleep, awake, greeted, listening, loading, dead, running };

  void follow_pins(std::int64_t now_ns);
  void take(const FtdiBridge::LineByte& byte);
  void greet(const FtdiBridge::LineByte& byte);
  void load(const FtdiBridge::LineByte& byte);
  void start_firmware(std::int64_t now_ns);
  void hear(const FtdiBridge::LineByte& byte);
  void obey(const FalconCommand& command, std::int64_t now_ns);
  void expire(std::int64_t now_ns);
  void reply(std::int64_t now_ns);
  void say(std::span<const std::uint8_t> bytes, double baud, std::int64_t now_ns);
  double baud() const;
  std::int64_t silent_ns() const;
  std::int64_t stale_at_ns() const;
  std::int64_t homes_at_ns() const;

  FalconBoardOptions options_;
  FtdiBridge& bridge_;
  std::array<Leg, 3> legs_;
  Mode mode_ = Mode::asleep;
  bool was_dtr_ = true;
  std::uint32_t heard_ = 0;  ///< the last three bytes of a greeting
  int greetings_ = 0, wrong_echoes_ = 0, died_ = 0;
  std::size_t uploaded_ = 0;
  bool as_wanted_ = true;
  FalconFrames frames_;
  FalconCommand command_;
  std::uint64_t commands_ = 0;
  std::int64_t commanded_ns_ = 0, fresh_since_ns_ = 0, homing_since_ns_ = kNever;
  std::uint8_t homed_ = 0, grip_ = 0;
  bool stale_ = false, purged_ = false, baud_set_ = false;
};

}  // namespace hapticd::sim::usb
