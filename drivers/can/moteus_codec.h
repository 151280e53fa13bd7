// moteus' register protocol over CAN FD: frames to bytes and back. Pure: no socket, no clock, no state.
//
// A payload is a list of subframes: write or read so many registers from one on, in one format. Writing `mode` begins a
// new command, and every field of a command that a frame leaves out takes its default: so a torque is sent as a whole
// command in each frame, integrator limit included. Units are the servo's: turns, turns/s, N m at the output, V, degrees
// Celsius. Little endian.
#pragma once
#include <cstdint>
#include <optional>
#include <string_view>

#include "drivers/can/frame.h"

namespace hapticd::can::moteus {

/// The registers that are used here.
enum class Register : std::uint16_t {
  mode = 0x000,
  position = 0x001,
  velocity = 0x002,
  torque = 0x003,
  voltage = 0x00d,
  temperature = 0x00e,
  fault = 0x00f,
  command_position = 0x020,
  command_velocity = 0x021,
  feedforward_torque = 0x022,
  kp_scale = 0x023,
  kd_scale = 0x024,
  maximum_torque = 0x025,
  watchdog_timeout = 0x027,
  ilimit_scale = 0x02b,
  ignore_position_bounds = 0x02d,
  within_lower = 0x040,
  within_upper = 0x041,
  within_feedforward_torque = 0x042,
  within_maximum_torque = 0x045,
  within_watchdog_timeout = 0x046,
  millisecond_counter = 0x070,
  register_map_version = 0x102,
  serial_number = 0x120,
};
inline constexpr int kRegisterMapVersion = 5;

enum class Mode : std::uint8_t {
  stopped = 0,
  fault = 1,
  position = 10,
  timeout = 11,
  stay_within = 13
};

enum class Format : std::uint8_t { int8, int16, int32, real };

struct Address {
  std::uint8_t servo = 1;   ///< 1 .. 126
  std::uint8_t source = 0;  ///< 0 .. 127
  std::uint16_t prefix = 0;
};
/// Of frames to the servo and from it; extended from 0x800 on.
Frame to_servo(const Address& address, bool reply) noexcept;
bool is_reply(const Frame& frame, const Address& address) noexcept;

/// Puts subframes into a frame; neighbouring registers in one format share one.
class Writer {
 public:
  explicit Writer(const Frame& header) noexcept : frame_(header) {}

  /// NaN is what the servo takes for "none". Values that are infinite, or too large for a single, are refused.
  Writer& write(Register which, Format format, double value) noexcept;
  Writer& read(Register which, Format format) noexcept;

  /// Padded to a legal length with the fast bit rate. Nothing: something was refused, or it does not fit.
  std::optional<Frame> finish() noexcept;
  /// Before padding.
  std::size_t size() const noexcept { return size_; }

 private:
  struct Run {
    bool reads = false;
    Format format = Format::int8;
    std::uint16_t first = 0;
    std::uint8_t count = 0;
    std::array<std::uint8_t, 64> values{};
    std::size_t bytes = 0;
  };
  bool extends(bool reads, std::uint16_t which, Format format) const noexcept;
  void begin(bool reads, std::uint16_t which, Format format) noexcept;
  void flush() noexcept;
  void append(std::uint8_t byte) noexcept;
  void append_varuint(std::uint32_t value) noexcept;

  Frame frame_;
  Run run_;
  std::size_t size_ = 0;
  bool good_ = true;
};

/// What is asked for beside mode, position and fault.
struct Query {
  bool motion = false;  ///< velocity and torque
  bool supply = false;  ///< voltage and temperature
  bool settings =
      false;  ///< what the running command has as maximum torque and watchdog; the time since it started
  /// 0 to 3: asks for other registers each, so that a reply says which question it answers.
  int tag = 0;
};

/// Of one tick. Torque alone: position NaN, no gains, no integrator.
struct TorqueCommand {
  double torque_Nm = 0;
  double maximum_torque_Nm = 0;  ///< the servo clips there
  double watchdog_s = 0;
  bool ignore_position_bounds = false;
};
/// At most 48 bytes, 64 while settings are asked for; the reply has at most 24 where only a tag is asked for. Without a query there is none. Nothing: not
/// finite.
std::optional<Frame> torque_command(const Address& address, const TorqueCommand& command,
                                    const std::optional<Query>& query) noexcept;
/// The commands of one drive whose torque and tag alone change: made once, so that a tick only puts the torque in.
class TorqueCommands {
 public:
  /// `asks`: each has a question, of its tag.
  TorqueCommands(const Address& address, const TorqueCommand& settings, bool asks) noexcept;
  /// As torque_command() makes it. Nothing: not finite, or the settings are not.
  std::optional<Frame> with(double torque_Nm, int tag) const noexcept;

 private:
  std::array<std::optional<Frame>, 4> frames_{};
};
Frame stop(const Address& address, const std::optional<Query>& query) noexcept;
Frame ask(const Address& address, const Query& query) noexcept;
/// Asks which register map the servo has, its serial number, and for how long it has run.
Frame ask_identity(const Address& address) noexcept;

// -- from the servo

enum class Status : std::uint8_t { ok, truncated, unknown_subframe, error_subframe };

/// What a reply had; absent is not 0.
struct Reply {
  std::optional<double> mode{}, position{}, velocity{}, torque{}, voltage{}, temperature{}, fault{},
      milliseconds{};
  std::optional<std::int32_t> register_map_version{};
  std::optional<double> maximum_torque{}, watchdog{};  ///< of the running command
  std::optional<std::int32_t> serial_number{};         ///< its first third
  /// Of the question.
  int tag() const noexcept { return (milliseconds ? 1 : 0) + (register_map_version ? 2 : 0); }
};
struct RegisterError {
  bool write = false;
  std::uint32_t which = 0, code = 0;
};
struct Decoded {
  Status status = Status::ok;
  Reply reply{};
  std::optional<RegisterError> error{};  ///< the first
};
Decoded decode(std::span<const std::uint8_t> payload) noexcept;

/// Word of a fault or limit code; empty: it has none.
std::string_view fault_word(int code) noexcept;
/// 96 to 103 in a running mode name what limits the torque: no fault.
bool is_limit(int code) noexcept;

}  // namespace hapticd::can::moteus
