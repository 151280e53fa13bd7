// The forces of an OpenFFBoard: switched on and off one report after the other, kept alive, followed.
//
//   off -> arming: magnitudes 0, effects set, actuators enabled, effects started -> running -> disarming: magnitudes 0,
//   effects stopped, actuators disabled -> off
//
// Before an effect is started its magnitude is 0, since it still has the one that it ended with.
#pragma once
#include <array>
#include <cstdint>
#include <optional>

#include "drivers/hid/openffboard_outbox.h"
#include "drivers/hid/openffboard_setup.h"
#include "drivers/usb/protocol.h"

namespace hapticd::hid::openffboard {

/// A question whose answer says whether forces are on, and that the board is alive.
inline constexpr Command kIsForceOn{
    .type = Type::read,
    .class_id = static_cast<std::uint16_t>(Class::main),
    .command = static_cast<std::uint32_t>(MainCommand::force_active)};

/// What goes out for an effort; not rounded.
double magnitude_of(const usb::DeviceOptions& options, std::size_t axis, double effort) noexcept;

class Force {
 public:
  explicit Force(const usb::DeviceOptions& options) : options_(options) {}
  void begin(const Board& board);

  /// The next reports, at most two. `sample_ns`: when the last sample came.
  usb::Status tell(usb::Port& port, const usb::Command& command, std::int64_t now_ns,
                   std::int64_t sample_ns);
  std::int64_t tell_again_ns(std::int64_t now_ns, std::int64_t sample_ns) const noexcept;
  /// Off, as far as there is time.
  void end(usb::Port& port, usb::Host& host, std::int64_t until_ns);

  /// The board says whether forces are on: in a report of its state, or as an answer. False: it is an answer to a question
  /// from before they were switched on.
  void is_said(bool on) noexcept;
  bool is_answered() noexcept;

  bool wanted() const noexcept { return phase_ == Phase::arming || phase_ == Phase::running; }
  bool on() const noexcept { return phase_ == Phase::running && enabled_; }
  /// They were on, are wanted, and the board says that they are not.
  bool lost() const noexcept { return was_on_ && !enabled_; }

 private:
  enum class Phase : std::uint8_t { off, arming, running, disarming };
  struct Axis {
    std::int16_t magnitude = 0;   ///< that was sent last
    std::int64_t sent_ns = 0;     ///< when
    std::int64_t started_ns = 0;  ///< when its effect was started last
  };

  void choose_phase(bool armed, std::int64_t now_ns) noexcept;
  usb::Status next(usb::Port& port, const usb::Command& command, std::int64_t now_ns,
                   std::int64_t sample_ns, bool& sent);
  usb::Status step(usb::Port& port, std::int64_t now_ns);
  usb::Status arming_step(usb::Port& port, std::int64_t now_ns);
  usb::Status disarming_step(usb::Port& port, std::int64_t now_ns);
  usb::Status set(usb::Port& port, std::size_t axis);
  usb::Status start(usb::Port& port, std::size_t axis, std::int64_t now_ns);
  usb::Status follow(usb::Port& port, std::size_t axis, std::int16_t magnitude,
                     std::int64_t now_ns);
  usb::Status ask(usb::Port& port, std::int64_t now_ns);
  std::int16_t wanted_magnitude(const usb::Command& command, std::size_t axis) const noexcept;
  std::optional<std::size_t> due_start(std::int64_t now_ns) const noexcept;
  std::int64_t ask_ns(std::int64_t sample_ns) const noexcept;
  std::optional<std::size_t> due_magnitude(const usb::Command& command,
                                           std::int64_t now_ns) const noexcept;
  std::int64_t dead_man_ns() const noexcept;

  const usb::DeviceOptions& options_;
  Board board_{};
  Outbox outbox_;
  Phase phase_ = Phase::off;
  std::size_t step_ = 0;
  std::array<Axis, kMostAxes> axes_{};
  bool enabled_ = false, was_on_ = false;
  std::int64_t asked_ns_ = 0;
  int unanswered_ = 0, outdated_ = 0;  ///< questions; of these: from before forces were switched on
  bool ask_by_effect_ = false;
  std::size_t since_other_ = kMostAxes;  ///< reports since the last that was a question or a start
};

}  // namespace hapticd::hid::openffboard
