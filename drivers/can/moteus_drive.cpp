#include "drivers/can/moteus_drive.h"

#include <algorithm>
#include <cmath>

namespace hapticd::can {
namespace {

using moteus::Mode;

constexpr int kModePosition = static_cast<int>(Mode::position);
/// From stopped to running: the servo measures its current offsets first (modes 2, 3, 4).
constexpr std::int64_t kStart_ns = 2'000'000'000;

bool is(const std::optional<double>& value, Mode mode) noexcept {
  return value && *value == static_cast<double>(mode);
}

/// Of a register that holds a code: -1 where it is none.
int code_of(double value) noexcept {
  return value >= 0 && value <= 0xffff ? static_cast<int>(value) : -1;
}

/// What the wire carries comes back the same, but for rounding to a float.
bool as_asked(const std::optional<double>& found, double asked) noexcept {
  return found && std::abs(*found - asked) <= 1e-6 * std::abs(asked);
}

/// Since it started; a 32-bit counter.
std::uint32_t milliseconds_of(const moteus::Reply& reply) noexcept {
  const double value = reply.milliseconds.value_or(0);
  return std::abs(value) < 4e9 ? static_cast<std::uint32_t>(static_cast<std::int64_t>(value)) : 0;
}

}  // namespace

MoteusDrive::MoteusDrive(const DeviceOptions& device, const DriveOptions& options)
    : Drive(device, options),
      address_{.servo = options.node, .source = device.source, .prefix = device.prefix},
      commands_(address_, settings(), !in_phase()) {}

/// What the servo is told with each torque.
moteus::TorqueCommand MoteusDrive::settings() const noexcept {
  return {.torque_Nm = 0,
          .maximum_torque_Nm = max_torque_Nm(),
          .watchdog_s = device_.watchdog_s,
          .ignore_position_bounds = device_.ignore_position_bounds};
}

std::vector<Filter> MoteusDrive::filters() const {
  const std::uint32_t prefix = static_cast<std::uint32_t>(address_.prefix) << 16;
  const std::uint32_t reply =
      prefix | static_cast<std::uint32_t>(address_.servo) << 8 | address_.source;
  const std::uint32_t command = prefix | address_.servo;
  std::vector<Filter> filters{{.id = reply, .mask = 0x1fffffff, .extended = reply >= 0x800},
                              // commands of any other host
                              {.id = command | 0x8000, .mask = 0x1fff80ff, .extended = true}};
  if (prefix == 0) filters.push_back({.id = command, .mask = 0x0ff, .extended = false});
  return filters;
}

Result<std::string> MoteusDrive::connect(Conversation& conversation) {
  constexpr int kTries = 3;
  constexpr double kAnswer_s = 0.2;
  conversation.send(moteus::stop(address_, std::nullopt));
  for (int i = 0; i < kTries; ++i) {
    conversation.send(moteus::ask_identity(address_));
    const std::int64_t until_ns = conversation.now_ns() + std::llround(kAnswer_s * 1e9);
    while (conversation.now_ns() < until_ns) {
      const auto frame = conversation.next(kAnswer_s);
      if (!frame) break;
      if (!moteus::is_reply(*frame, address_)) continue;
      const moteus::Reply reply = moteus::decode(frame->payload()).reply;
      if (!reply.register_map_version) continue;
      if (*reply.register_map_version != moteus::kRegisterMapVersion) {
        return hapticd::fail(ExitCode::unavailable,
                             place_of(options_) + ": this servo has register map " +
                                 std::to_string(*reply.register_map_version) + ", expected " +
                                 std::to_string(moteus::kRegisterMapVersion) +
                                 ": update its firmware");
      }
      knows_position_ = true;
      lost_ = false;
      up_ms_ = milliseconds_of(reply);
      up_at_ns_ = conversation.now_ns();
      heard_ns_ = 0;
      go(Stage::off);
      return "moteus, register map " + std::to_string(*reply.register_map_version);
    }
  }
  return hapticd::fail(ExitCode::unavailable,
                       place_of(options_) +
                           ": no moteus answers; check its power, the cable, its id (id.id), "
                           "can.prefix, and both bit rates of the interface");
}

// -- loop

moteus::Query MoteusDrive::next_query() noexcept {
  asks_time_ = stage_ != Stage::armed;
  tag_ = asks_time_ ? (tag_ == 1 ? 3 : 1) : (tag_ + 1) & 3;  // 1 and 3 ask for its time
  return {.settings = asks_time_, .tag = tag_};
}

void MoteusDrive::query(Outbox& outbox) noexcept {
  if (in_phase()) outbox.add(moteus::ask(address_, next_query()));
}

std::optional<moteus::Query> MoteusDrive::query_with_command() noexcept {
  if (in_phase()) return std::nullopt;
  return next_query();
}

/// To this servo, whether it is to answer or not.
bool MoteusDrive::of_another_master(const Frame& frame) const noexcept {
  return (frame.id & 0x7f) == address_.servo && frame.id >> 16 == address_.prefix;
}

Heard MoteusDrive::take(const Frame& frame, std::int64_t stamp_ns) noexcept {
  if (frame.error || frame.remote) return Heard::nothing;
  if (!moteus::is_reply(frame, address_))
    return of_another_master(frame) ? Heard::other_master : Heard::nothing;
  const moteus::Decoded decoded = moteus::decode(frame.payload());
  if (decoded.status == moteus::Status::error_subframe)
    fail("the servo refused a register", {}, "update its firmware");
  if (decoded.status != moteus::Status::ok) return Heard::something;
  const moteus::Reply& reply = decoded.reply;
  if (reply.tag() != tag_) return Heard::something;  // answers an older question
  hear(reply);
  if (!reply.position || !std::isfinite(*reply.position)) return Heard::something;
  measured(options_.counts_per_turn * *reply.position, stamp_ns);
  return Heard::sample;
}

void MoteusDrive::hear(const moteus::Reply& reply) noexcept {
  watch_time(reply);
  if (!reply.mode || !reply.fault) return;
  mode_ = code_of(*reply.mode);
  const int code = code_of(*reply.fault);
  limits_ = moteus::is_limit(code) ? static_cast<std::uint16_t>(1u << (code - 96)) : 0;
  faults_ = is(reply.mode, Mode::fault) ? static_cast<std::uint32_t>(std::max(code, 0)) : 0;
  if (stage_ == Stage::off || stage_ == Stage::stopping) return;
  if (is(reply.mode, Mode::fault))
    return fail("the servo reports a fault", moteus::fault_word(code));
  if (is(reply.mode, Mode::timeout)) return fail("the servo's watchdog expired");
  if (stage_ == Stage::starting) return hear_starting(reply);
  if (mode_ == kModePosition) return;
  lost_ = true;
  fail("the servo left its torque mode: it restarted, or somebody stopped it");
}

/// Running, and with the settings that were asked for. It may be to stop by now.
void MoteusDrive::hear_starting(const moteus::Reply& reply) noexcept {
  if (!arm_wanted_ || failed()) return;
  if (mode_ != kModePosition || !reply.maximum_torque || !reply.watchdog) return;
  if (!as_asked(reply.watchdog, device_.watchdog_s))
    return fail("the servo has another watchdog time than it was told");
  if (!as_asked(reply.maximum_torque, max_torque_Nm()))
    return fail("the servo has another maximum torque than it was told");
  go(Stage::armed);
}

/// A servo whose own time did not go on as ours, or that was silent for long, was without power: where it counts from is
/// not known any more.
void MoteusDrive::watch_time(const moteus::Reply& reply) noexcept {
  constexpr std::int64_t kClocks = 50;  // may differ by a part of so many
  constexpr std::int64_t kOnItsWay_ms =
      500;  // a reply may have waited; a servo that restarted begins at 0
  constexpr std::int64_t kLongest_ns = 1'000'000'000;
  lost_ = lost_ || (heard_ns_ != 0 && now_ns_ - heard_ns_ > kLongest_ns);
  heard_ns_ = now_ns_;
  if (!asks_time_ || !reply.milliseconds) return;
  const std::int64_t passed_ms = (now_ns_ - up_at_ns_) / 1'000'000;
  const std::int64_t allowed_ms = passed_ms / kClocks + kOnItsWay_ms;
  const std::uint32_t up_ms = milliseconds_of(reply);  // it wraps, and so does the difference
  const auto ahead_ms =
      static_cast<std::int32_t>(up_ms - up_ms_ - static_cast<std::uint32_t>(passed_ms));
  lost_ = lost_ || ahead_ms < -allowed_ms;
  up_ms_ = up_ms;
  up_at_ns_ = now_ns_;
}

void MoteusDrive::go(Stage stage) noexcept {
  stage_ = stage;
  since_ns_ = now_ns_;
  armed_ = stage == Stage::armed;
}

void MoteusDrive::command(double torque_Nm, Outbox& outbox) noexcept {
  switch (stage_) {
    case Stage::off:
      return;
    case Stage::stopping:  // first of all: what may still be queued then meets a servo that is off
      if (mode_ == static_cast<int>(Mode::stopped) && now_ns_ > since_ns_) {
        go(Stage::starting);
        return start(outbox);
      }
      outbox.add(moteus::stop(address_, query_with_command()));
      break;
    case Stage::starting:
      start(outbox);
      break;
    case Stage::armed:
      return torque(torque_Nm, outbox);
  }
  if (now_ns_ - since_ns_ > kStart_ns)
    fail("the servo did not start within two seconds", {}, "is it calibrated?");
}

void MoteusDrive::start(Outbox& outbox) noexcept {
  outbox.add(moteus::torque_command(address_, settings(), query_with_command()));
}

void MoteusDrive::torque(double torque_Nm, Outbox& outbox) noexcept {
  const auto query = query_with_command();
  const auto frame = commands_.with(torque_Nm, query ? query->tag : 0);
  outbox.add(frame);
  carried_Nm_ = frame ? static_cast<double>(static_cast<float>(torque_Nm)) : 0;
}

void MoteusDrive::stop(bool must, Outbox& outbox) noexcept {
  stage_ = Stage::off;
  if (must) {
    outbox.add(moteus::stop(address_, query_with_command()));
  } else if (!in_phase()) {
    outbox.add(moteus::ask(address_, next_query()));
  }
}

}  // namespace hapticd::can
