#include "drivers/hid/openffboard_force.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hapticd::hid::openffboard {
namespace {

using usb::Status;

constexpr double kFullMagnitude = 32767;
constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr std::int64_t kRefresh_ns = 10 * kMillisecond_ns;  // of a magnitude that does not change
/// Answers and positions come by the same endpoint, one in a millisecond: half of them at most.
constexpr std::int64_t kAskSeldom_ns = 2 * kMillisecond_ns;
constexpr std::int64_t kAskAlways_ns = 50 * kMillisecond_ns;
constexpr std::int64_t kConfirm_ns = 5 * kMillisecond_ns;
constexpr std::int64_t kTellSoon_ns = kMillisecond_ns / 2, kTellAgain_ns = 5 * kMillisecond_ns;
/// From the start's being sent to its being with the board: a report before it, and a host that is late. At most a quarter
/// of the effect's time.
constexpr std::int64_t kMargin_ns = 4 * kMillisecond_ns;
constexpr int kMostUnanswered = 20, kMostOutstanding = 10;

}  // namespace

double magnitude_of(const usb::DeviceOptions& options, std::size_t axis, double effort) noexcept {
  const double sign = options.axes[axis].counts_per_unit < 0 ? 1 : -1;
  return sign * effort * kFullMagnitude / options.openffboard.full_torque_Nm;
}

void Force::begin(const Board& board) {
  board_ = board;
  outbox_ = {};
  phase_ = Phase::off;
  axes_ = {};
  enabled_ = was_on_ = ask_by_effect_ = false;
  since_other_ = kMostAxes;
  asked_ns_ = 0;
  unanswered_ = outdated_ = 0;
}

std::int64_t Force::dead_man_ns() const noexcept {
  return std::llround(1e9 * options_.openffboard.dead_man_s);
}

// -- what is said

void Force::is_said(bool on) noexcept {
  if (!on) enabled_ = false;
  if (on && phase_ == Phase::running) enabled_ = was_on_ = true;
}

bool Force::is_answered() noexcept {
  // Of those that were asked longer ago no answer will come.
  unanswered_ = std::clamp(unanswered_ - 1, 0, kMostOutstanding);
  if (outdated_ == 0) return true;
  --outdated_;
  return false;
}

// -- what is told

Status Force::tell(usb::Port& port, const usb::Command& command, std::int64_t now_ns,
                   std::int64_t sample_ns) {
  choose_phase(command.armed, now_ns);
  for (int i = 0; i < 2; ++i) {
    bool sent = false;
    if (const Status status = next(port, command, now_ns, sample_ns, sent); status != Status::ok)
      return status;
    // A port that sends while the caller waits has taken its time.
    if (!sent || port.outgoing().since_ns == 0) break;
  }
  return Status::ok;
}

void Force::choose_phase(bool armed, std::int64_t now_ns) noexcept {
  if (armed && !wanted()) {
    phase_ = Phase::arming;
    step_ = 0;
    enabled_ = was_on_ = false;
    outdated_ = unanswered_;
  } else if (!armed && wanted()) {
    phase_ = Phase::disarming;
    step_ = 0;
    enabled_ = was_on_ = false;
  } else if (phase_ == Phase::running) {
    const std::int64_t safe_ns = dead_man_ns() - std::min(kMargin_ns, dead_man_ns() / 4);
    const auto ended = [&](const Axis& axis) { return now_ns - axis.started_ns >= safe_ns; };
    // Told too late: an effect may have ended, and would begin again at full force.
    if (std::any_of(axes_.begin(), axes_.begin() + static_cast<std::ptrdiff_t>(board_.layout.axes),
                    ended)) {
      phase_ = Phase::arming;
      step_ = 0;
    }
  }
}

/// One report, if one is due and there is room for it.
Status Force::next(usb::Port& port, const usb::Command& command, std::int64_t now_ns,
                   std::int64_t sample_ns, bool& sent) {
  const bool free = outbox_.is_free(port);
  sent = free;
  if (phase_ == Phase::arming || phase_ == Phase::disarming) {
    // The zeros first.
    const bool may_ask = free && step_ >= board_.layout.axes && since_other_ > 0;
    if (may_ask && now_ns >= ask_ns(sample_ns)) return ask(port, now_ns);
    // Zero in place of a force that waits.
    sent = free || (step_ < board_.layout.axes && outbox_.waiting(port) == step_);
    return sent ? step(port, now_ns) : Status::ok;
  }
  const bool running = phase_ == Phase::running;
  const auto to_start = running ? due_start(now_ns) : std::nullopt;
  const auto due = running ? due_magnitude(command, now_ns) : std::nullopt;
  // A force waits for one other report at most.
  const bool forces_first = due && since_other_ < board_.layout.axes;
  if (free && to_start && !forces_first) return start(port, *to_start, now_ns);
  if (free && now_ns >= ask_ns(sample_ns) && !forces_first) return ask(port, now_ns);
  const auto axis = free ? due : outbox_.waiting(port);
  sent = running && axis.has_value();
  if (!sent) return Status::ok;
  const std::int16_t magnitude = wanted_magnitude(command, *axis);
  sent = free || magnitude != axes_[*axis].magnitude;
  return sent ? follow(port, *axis, magnitude, now_ns) : Status::ok;
}

Status Force::step(usb::Port& port, std::int64_t now_ns) {
  const Status status =
      phase_ == Phase::arming ? arming_step(port, now_ns) : disarming_step(port, now_ns);
  if (status != Status::ok) return status;
  const std::size_t axes = board_.layout.axes;
  const std::size_t steps = phase_ == Phase::arming ? 3 * axes + 1 : 2 * axes + 1;
  ++since_other_;
  if (++step_ < steps) return status;
  phase_ = phase_ == Phase::arming ? Phase::running : Phase::off;
  if (phase_ == Phase::running) outdated_ = unanswered_;
  return status;
}

Status Force::arming_step(usb::Port& port, std::int64_t now_ns) {
  const std::size_t axes = board_.layout.axes;
  if (step_ < axes) return follow(port, step_, 0, now_ns);
  if (step_ < 2 * axes) return set(port, step_ - axes);
  if (step_ == 2 * axes) return outbox_.send(port, device_control(Control::enable_actuators));
  return start(port, step_ - 2 * axes - 1, now_ns);
}

Status Force::disarming_step(usb::Port& port, std::int64_t now_ns) {
  const std::size_t axes = board_.layout.axes;
  if (step_ < axes) return follow(port, step_, 0, now_ns);
  if (step_ < 2 * axes) return outbox_.send(port, stop_effect(board_.effects[step_ - axes]));
  return outbox_.send(port, device_control(Control::disable_actuators));
}

Status Force::set(usb::Port& port, std::size_t axis) {
  const ReportBytes report = set_effect(board_, axis, options_.openffboard.dead_man_s);
  return outbox_.send(port, std::span(report).first(board_.layout.set_effect_bytes));
}

Status Force::start(usb::Port& port, std::size_t axis, std::int64_t now_ns) {
  const Status status = outbox_.send(port, start_effect(board_.effects[axis]));
  if (status == Status::ok) axes_[axis].started_ns = now_ns;
  since_other_ = 0;
  return status;
}

/// While it is switched on and off a magnitude must not be replaced; but for that only a newer one may.
Status Force::follow(usb::Port& port, std::size_t axis, std::int16_t magnitude,
                     std::int64_t now_ns) {
  const auto encoded = encode_magnitude(board_.effects[axis], magnitude);
  if (!encoded) return Status::failed;
  const Status status = outbox_.send(port, encoded->report,
                                     phase_ == Phase::running ? std::optional(axis) : std::nullopt);
  if (status != Status::ok) return status;
  axes_[axis].magnitude = magnitude;
  axes_[axis].sent_ns = now_ns;
  ++since_other_;
  return status;
}

/// Older firmware may not know the question; it tells its state after Set Effect.
Status Force::ask(usb::Port& port, std::int64_t now_ns) {
  // Answers that have not come by now never will.
  if (now_ns - asked_ns_ >= kAskAlways_ns) unanswered_ = outdated_ = 0;
  asked_ns_ = now_ns;
  since_other_ = 0;
  ask_by_effect_ = phase_ == Phase::running && !enabled_ && !was_on_ && !ask_by_effect_;
  if (ask_by_effect_) return set(port, 0);
  ++unanswered_;
  return outbox_.send(port, encode(kIsForceOn));
}

// -- what is due

std::int16_t Force::wanted_magnitude(const usb::Command& command, std::size_t axis) const noexcept {
  if (!enabled_) return 0;
  const auto encoded =
      encode_magnitude(board_.effects[axis], magnitude_of(options_, axis, command.effort[axis]));
  return encoded ? encoded->magnitude : std::int16_t{0};
}

std::optional<std::size_t> Force::due_start(std::int64_t now_ns) const noexcept {
  for (std::size_t i = 0; i < board_.layout.axes; ++i)
    if (now_ns - axes_[i].started_ns >= dead_man_ns() / 3) return i;
  return std::nullopt;
}

/// When the next question is due: so early that its answer, a sample, is there before the last one is too old.
std::int64_t Force::ask_ns(std::int64_t sample_ns) const noexcept {
  const std::int64_t always_ns = asked_ns_ == 0 ? 0 : asked_ns_ + kAskAlways_ns;
  // It may have to wait for a start, for the forces, and for the next frame.
  const double early_s = 1e-3 * static_cast<double>(board_.layout.axes + 2);
  const double wait_s = most_between_samples_s(options_) - board_.round_trip_s - early_s;
  const auto wait_ns = std::max<std::int64_t>(0, std::llround(1e9 * wait_s));
  const std::int64_t for_age_ns = std::max(sample_ns + wait_ns, asked_ns_ + kAskSeldom_ns);
  const std::int64_t to_confirm_ns = asked_ns_ + kConfirm_ns;
  const bool answers = unanswered_ < kMostUnanswered,
             confirmed = phase_ != Phase::running || enabled_;
  return std::min(
      {always_ns, answers ? for_age_ns : always_ns, confirmed ? always_ns : to_confirm_ns});
}

/// A question that found the port taken is tried again soon.
std::int64_t Force::tell_again_ns(std::int64_t now_ns, std::int64_t sample_ns) const noexcept {
  const std::int64_t most_ns = std::min(dead_man_ns() / 3, kTellAgain_ns);
  return std::clamp(ask_ns(sample_ns), now_ns + kTellSoon_ns, now_ns + most_ns);
}

/// Of those that have changed, or are to be said again, the one that was not told for the longest time.
std::optional<std::size_t> Force::due_magnitude(const usb::Command& command,
                                                std::int64_t now_ns) const noexcept {
  std::optional<std::size_t> due;
  for (std::size_t i = 0; i < board_.layout.axes; ++i) {
    const bool changed = wanted_magnitude(command, i) != axes_[i].magnitude;
    if (!changed && now_ns - axes_[i].sent_ns < kRefresh_ns) continue;
    if (!due || axes_[i].sent_ns < axes_[*due].sent_ns) due = i;
  }
  return due;
}

// -- the way out

void Force::end(usb::Port& port, usb::Host& host, std::int64_t until_ns) {
  bool first = true;
  const auto tell = [&](std::span<const std::uint8_t> report) {
    if (!std::exchange(first, false) && host.now_ns() >= until_ns) return;
    usb::send_last(host, port, until_ns, [&] { return port.send(report); });
  };
  for (std::size_t i = 0; i < board_.layout.axes; ++i)
    if (const auto zero = encode_magnitude(board_.effects[i], 0)) tell(zero->report);
  for (std::size_t i = 0; i < board_.layout.axes; ++i)
    if (board_.effects[i] != 0) tell(stop_effect(board_.effects[i]));
  tell(device_control(Control::disable_actuators));
  phase_ = Phase::off;
  enabled_ = was_on_ = false;
}

}  // namespace hapticd::hid::openffboard
