#include "drivers/can/odrive_drive.h"

#include <cmath>

namespace hapticd::can {
namespace {

using odrive::AxisState;

constexpr std::uint32_t kWatchdogExpired = 1u << 24;
constexpr std::uint8_t kBusy = 1;
/// A drive has this long to enter closed loop, beside the time to its next heartbeat.
constexpr std::int64_t kEnter_ns = 1'000'000'000;
/// An answer to a question outside of the loop's samples.
constexpr std::int64_t kAnswer_ns = 100'000'000;
/// How long the host is silent, in watchdog times.
constexpr double kSilence = 1.5;

std::int64_t ns(double seconds) noexcept {
  return std::llround(seconds * 1e9);
}

std::string_view first_word(std::uint32_t errors) noexcept {
  for (int bit = 0; bit < 32; ++bit) {
    if ((errors >> bit & 1u) == 0) continue;
    const std::string_view word = odrive::error_word(bit);
    return word.empty() ? std::string_view("an error that this version does not know") : word;
  }
  return {};
}

std::string dotted(const std::uint8_t (&parts)[3]) {
  return std::to_string(parts[0]) + "." + std::to_string(parts[1]) + "." + std::to_string(parts[2]);
}

}  // namespace

std::vector<Filter> OdriveDrive::filters() const {
  return {{.id = static_cast<std::uint32_t>(options_.node) << 5, .mask = 0x7e0}};
}

// -- set-up

Result<std::string> OdriveDrive::connect(Conversation& conversation) {
  conversation.send(odrive::set_axis_state(options_.node, AxisState::idle));
  auto version = find(conversation);
  if (!version) return tl::unexpected(version.error());
  if (version->firmware[0] != 0 || version->firmware[1] != 6) {
    return hapticd::fail(
        ExitCode::unavailable,
        place_of(options_) + ": this ODrive has firmware " + dotted(version->firmware) +
            ", expected 0.6: others have other error bits and messages; update it");
  }
  if (auto heard = listen(conversation); !heard) return tl::unexpected(heard.error());
  watchdog_proved_ = knows_position_ = lost_ = false;
  heartbeat_ns_ = 0;
  go(Stage::off);
  return "ODrive " + dotted(version->hardware) + ", firmware " + dotted(version->firmware);
}

Result<odrive::Version> OdriveDrive::find(Conversation& conversation) const {
  constexpr int kTries = 3;
  constexpr double kAnswer_s = 0.2;
  for (int i = 0; i < kTries; ++i) {
    conversation.send(odrive::request(options_.node, odrive::Command::get_version));
    const std::int64_t until_ns = conversation.now_ns() + ns(kAnswer_s);
    while (conversation.now_ns() < until_ns) {
      const auto frame = conversation.next(kAnswer_s);
      if (!frame) break;
      const odrive::Decoded decoded = odrive::decode(*frame, options_.node);
      if (const auto* version = std::get_if<odrive::Version>(&decoded.message)) return *version;
    }
  }
  return hapticd::fail(ExitCode::unavailable,
                       place_of(options_) +
                           ": no ODrive answers; check its power, the cable, its node id "
                           "(axis0.config.can.node_id) and bit rate (can.config.baud_rate)");
}

/// Heartbeats, and with free-running samples their rate, must be as the config says: the proof rests on it.
Result<void> OdriveDrive::listen(Conversation& conversation) const {
  const std::int64_t start_ns = conversation.now_ns();
  const std::int64_t until_ns = start_ns + ns(2.5 * device_.heartbeat_every_s);
  int heartbeats = 0, estimates = 0;
  while (conversation.now_ns() < until_ns) {
    const auto frame =
        conversation.next(1e-9 * static_cast<double>(until_ns - conversation.now_ns()));
    if (!frame) break;
    const auto command = static_cast<odrive::Command>(frame->id & 0x1f);
    if (frame->remote || frame->id >> 5 != options_.node) continue;
    heartbeats += command == odrive::Command::heartbeat ? 1 : 0;
    estimates += command == odrive::Command::get_encoder_estimates ? 1 : 0;
  }
  if (heartbeats < 2) {
    return hapticd::fail(ExitCode::unavailable,
                         place_of(options_) + ": expected a heartbeat every " +
                             std::to_string(ns(device_.heartbeat_every_s) / 1'000'000) +
                             " ms, found " + std::to_string(heartbeats) + " in " +
                             std::to_string(ns(2.5 * device_.heartbeat_every_s) / 1'000'000) +
                             " ms; set axis0.config.can.heartbeat_msg_rate_ms, or "
                             "can.heartbeat_every_s of the config");
  }
  if (device_.timing != drivers::Timing::free_running) return {};
  const double expected = 2.5 * device_.heartbeat_every_s / device_.estimates_every_s;
  if (estimates >= 0.9 * expected - 2) return {};
  return hapticd::fail(
      ExitCode::unavailable,
      place_of(options_) + ": expected its position every " +
          std::to_string(ns(device_.estimates_every_s) / 1000) + " us, " +
          std::to_string(std::llround(expected)) + " times, found " + std::to_string(estimates) +
          "; set axis0.config.can.encoder_msg_rate_ms, or can.estimates_every_s of the config");
}

// -- loop

void OdriveDrive::query(Outbox& outbox) noexcept {
  if (device_.timing == drivers::Timing::in_phase && !silent_)
    outbox.add(odrive::request(options_.node, odrive::Command::get_encoder_estimates));
}

Heard OdriveDrive::take(const Frame& frame, std::int64_t stamp_ns) noexcept {
  const odrive::Decoded decoded = odrive::decode(frame, options_.node);
  switch (decoded.received) {
    case odrive::Received::ok:
      break;
    case odrive::Received::other_master:
      return Heard::other_master;
    case odrive::Received::malformed:
    case odrive::Received::non_finite:
      return Heard::something;
    default:
      return Heard::nothing;
  }
  if (const auto* heartbeat = std::get_if<odrive::Heartbeat>(&decoded.message))
    hear(*heartbeat, stamp_ns);
  if (const auto* errors = std::get_if<odrive::Errors>(&decoded.message)) {
    errors_ = *errors;
    errors_ns_ = stamp_ns;
  }
  const auto* estimates = std::get_if<odrive::Estimates>(&decoded.message);
  if (estimates == nullptr) return Heard::something;
  measured(options_.counts_per_turn * static_cast<double>(estimates->position_turns), stamp_ns);
  return Heard::sample;
}

bool OdriveDrive::heard_since(std::int64_t time_ns) const noexcept {
  return heartbeat_ns_ > time_ns + ns(device_.period_s);
}

bool OdriveDrive::closed_loop() const noexcept {
  return heartbeat_.state == static_cast<std::uint8_t>(AxisState::closed_loop);
}

std::int64_t OdriveDrive::heartbeat_limit_ns() const noexcept {
  return ns(3 * device_.heartbeat_every_s);
}

/// A drive that fell silent for long, or is initializing, was without power: where it counts from is not known any more.
void OdriveDrive::hear(const odrive::Heartbeat& heartbeat, std::int64_t stamp_ns) noexcept {
  constexpr std::uint32_t kInitializing = 1;
  // Before it was armed for the first time nothing of it is relied on yet.
  const bool gap = heartbeat_ns_ != 0 && stamp_ns - heartbeat_ns_ > heartbeat_limit_ns();
  lost_ = lost_ || (watchdog_proved_ && (gap || (heartbeat.error & kInitializing) != 0));
  heartbeat_ = heartbeat;
  heartbeat_ns_ = stamp_ns;
  faults_ = heartbeat.error;
  if (stage_ != Stage::armed) return;
  if (heartbeat.error != 0) {
    fail("the drive reports an error", first_word(heartbeat.error));
  } else if (!closed_loop()) {
    lost_ = true;
    fail("the drive left closed loop without an error: it restarted, or somebody set it idle");
  }
}

void OdriveDrive::go(Stage stage) noexcept {
  stage_ = stage;
  since_ns_ = now_ns_;
  step_ = 0;
  armed_ = stage == Stage::armed;
  knows_position_ = knows_position_ || armed_;  // before closed loop it may say 0
  silent_ = stage == Stage::silence || stage == Stage::ask;
}

void OdriveDrive::command(double torque_Nm, Outbox& outbox) noexcept {
  switch (stage_) {
    case Stage::off:
      return;
    case Stage::idle:  // first of all: what may still be queued then meets a drive that is off
      outbox.add(odrive::set_axis_state(options_.node, AxisState::idle));
      return go(Stage::prepare);
    case Stage::prepare:
      return prepare(outbox);
    case Stage::enter:
      return enter(outbox);
    case Stage::silence:
      if (now_ns_ - since_ns_ >= ns(kSilence * device_.watchdog_s)) go(Stage::ask);
      return;
    case Stage::ask:
      return ask(outbox);
    case Stage::armed:
      return drive(torque_Nm, outbox);
  }
}

/// One frame a tick: a queue need hold no more of them than of torques.
void OdriveDrive::prepare(Outbox& outbox) noexcept {
  const std::uint8_t node = options_.node;
  switch (step_++) {
    case 0:
      return outbox.add(odrive::set_controller_mode(node, odrive::ControlMode::torque,
                                                    odrive::InputMode::passthrough));
    case 1:
      if (options_.max_current_A > 0)
        outbox.add(odrive::set_limits(node, options_.max_velocity_turns_s, options_.max_current_A));
      return;
    case 2:
      return outbox.add(odrive::clear_errors(node));
    case 3:
      return outbox.add(odrive::set_input_torque(node, 0));
    default:
      outbox.add(odrive::set_axis_state(node, AxisState::closed_loop));
      go(Stage::enter);
  }
}

void OdriveDrive::enter(Outbox& outbox) noexcept {
  outbox.add(odrive::set_input_torque(options_.node, 0));
  if (heard_since(since_ns_) && heartbeat_.error != 0)
    return fail("the drive would not enter closed loop", first_word(heartbeat_.error));
  if (heard_since(since_ns_) && closed_loop() && heartbeat_.procedure_result != kBusy) {
    return go(watchdog_proved_ ? Stage::armed : Stage::silence);
  }
  if (now_ns_ - since_ns_ > kEnter_ns + heartbeat_limit_ns())
    fail("the drive did not enter closed loop within a second",
         "is it calibrated (axis0.requested_state = FULL_CALIBRATION_SEQUENCE)?");
}

/// The host was silent for so long that the watchdog must have expired: the drive has to say so itself, and at once, since
/// its next heartbeat may come much later.
void OdriveDrive::ask(Outbox& outbox) noexcept {
  if (errors_ns_ <= since_ns_) {
    if (now_ns_ - since_ns_ > kAnswer_ns)
      return fail("the drive does not tell its errors (Get_Error)");
    return outbox.add(odrive::request(options_.node, odrive::Command::get_error));
  }
  if (((errors_.active | errors_.disarm_reason) & kWatchdogExpired) == 0) {
    return fail("left alone for 1.5 x can.watchdog_s, the drive did not go off by its watchdog", {},
                "set axis0.config.enable_watchdog = True and watchdog_timeout = can.watchdog_s");
  }
  watchdog_proved_ = true;
  go(Stage::idle);
}

void OdriveDrive::drive(double torque_Nm, Outbox& outbox) noexcept {
  if (now_ns_ - heartbeat_ns_ > heartbeat_limit_ns())
    return fail("the drive sends no heartbeat any more");
  const auto frame = odrive::set_input_torque(options_.node, torque_Nm);
  outbox.add(frame);
  carried_Nm_ = frame ? static_cast<double>(static_cast<float>(torque_Nm)) : 0;
}

void OdriveDrive::stop(bool must, Outbox& outbox) noexcept {
  stage_ = Stage::off;
  if (must) outbox.add(odrive::set_axis_state(options_.node, AxisState::idle));
}

}  // namespace hapticd::can
