#include "drivers/can/cia402_drive.h"

#include <algorithm>
#include <cmath>

#include "drivers/can/cia402_setup.h"

namespace hapticd::can {
namespace {

using cia402::NodeState;
using cia402::State;

constexpr std::uint16_t kSwitchOff = 0x06;
constexpr std::uint16_t kResetFault = 0x80;
constexpr std::int64_t kEnable_ns = 2'000'000'000;
/// The host's heartbeat comes so often in the time after which a drive misses it.
constexpr double kHeartbeats = 3;

std::int64_t ns(double seconds) noexcept {
  return std::llround(seconds * 1e9);
}

}  // namespace

std::vector<Filter> Cia402Drive::filters() const {
  std::vector<Filter> filters;
  // NMT and SYNC of another master; emergency, PDOs, SDOs, heartbeat of this node, both ways.
  for (const std::uint32_t id : {0x000u, 0x080u}) filters.push_back({.id = id, .mask = 0x7ff});
  for (const std::uint32_t base : {0x080u, 0x180u, 0x200u, 0x580u, 0x600u, 0x700u})
    filters.push_back({.id = base + options_.node, .mask = 0x7ff});
  return filters;
}

Result<std::string> Cia402Drive::connect(Conversation& conversation) {
  const auto found = cia402::set_up(conversation, {.node = options_.node,
                                                   .host_node = device_.host_node,
                                                   .period_s = device_.period_s,
                                                   .watchdog_s = device_.watchdog_s,
                                                   .heartbeat_every_s = device_.heartbeat_every_s,
                                                   .place = place_of(options_)});
  if (!found) return tl::unexpected(found.error());
  rated_Nm_ = found->rated_torque_Nm;
  if (std::abs(found->counts_per_turn - options_.counts_per_turn) >
      1e-9 * options_.counts_per_turn) {
    return hapticd::fail(
        ExitCode::unavailable,
        place_of(options_) + ": the drive counts " + std::to_string(found->counts_per_turn) +
            " per turn (608F), the config says " + std::to_string(options_.counts_per_turn) +
            " (can.counts_per_turn): torque would be wrong by that factor");
  }
  if (found->max_torque_Nm * (1 + 1e-9) < max_torque_Nm()) {
    return hapticd::fail(ExitCode::unavailable,
                         place_of(options_) + ": the drive limits its torque to " +
                             std::to_string(found->max_torque_Nm) +
                             " N m (6072), the actuator of " + options_.axis + " is to give " +
                             std::to_string(max_torque_Nm()) +
                             " N m: lower its max_force_N or max_torque_Nm, or raise the limit");
  }
  heartbeat_ns_ = conversation.now_ns();
  knows_position_ = true;
  lost_ = false;
  return "CiA 402 drive, rated " + std::to_string(std::llround(1e3 * rated_Nm_)) + " mNm, " +
         std::to_string(std::llround(found->counts_per_turn)) + " counts per turn";
}

// -- loop

void Cia402Drive::query(Outbox& outbox) noexcept {
  if (!leads_) return;
  outbox.add(cia402::sync());
  if (now_ns_ - sent_heartbeat_ns_ < ns(device_.watchdog_s / kHeartbeats)) return;
  sent_heartbeat_ns_ = now_ns_;
  outbox.add(cia402::heartbeat(device_.host_node, NodeState::operational));
}

Heard Cia402Drive::take(const Frame& frame, std::int64_t stamp_ns) noexcept {
  if (cia402::is_sync(frame) || cia402::is_nmt(frame, options_.node)) return Heard::other_master;
  const cia402::Decoded decoded = cia402::decode(frame, options_.node);
  if (decoded.received == cia402::Received::other_master) return Heard::other_master;
  if (decoded.received == cia402::Received::malformed) return Heard::something;
  if (decoded.received != cia402::Received::ok) return Heard::nothing;
  if (decoded.emergency) hear_emergency(*decoded.emergency);
  if (decoded.guard) hear_heartbeat(decoded.guard->state, stamp_ns);
  if (!decoded.tpdo1) return Heard::something;
  hear_status(*decoded.tpdo1, stamp_ns);
  return Heard::sample;
}

void Cia402Drive::hear_status(const cia402::Tpdo1& pdo, std::int64_t stamp_ns) noexcept {
  state_ = cia402::state_of(pdo.status);
  limits_ = cia402::bits_of(pdo.status).internal_limit ? 1 : 0;
  measured(pdo.position, stamp_ns);
  if (armed_ && !running())
    fail("the drive left operation enabled, it is now", cia402::word_of(state_));
}

void Cia402Drive::hear_emergency(const cia402::Emergency& emergency) noexcept {
  faults_ = emergency.code;
  if (emergency.code == 0 || !arm_wanted_) return;
  const std::string_view word = cia402::emergency_word(emergency.code);
  fail("the drive reports an emergency", word.empty() ? "a code of its vendor's" : word);
}

void Cia402Drive::hear_heartbeat(NodeState state, std::int64_t stamp_ns) noexcept {
  heartbeat_ns_ = stamp_ns;
  if (state == NodeState::operational) return;
  lost_ = true;
  fail("the drive is no longer operational but", cia402::word_of(state),
       "it lost what it was told: restart hapticd");
}

void Cia402Drive::start_arming() noexcept {
  state_ =
      State::not_ready;  // until its next status: an old one may be from before it was switched off
  arming_since_ns_ = now_ns_;
  control_ = 0;
}

/// A fault is reset by the rise of a bit, so that 0 goes before it.
std::uint16_t Cia402Drive::next_control() noexcept {
  const std::uint16_t towards = cia402::towards_enabled(state_);
  return control_ = towards == kResetFault && control_ == kResetFault ? std::uint16_t{0} : towards;
}

void Cia402Drive::command(double torque_Nm, Outbox& outbox) noexcept {
  // Before, other drives may have been connected, and nobody heard it.
  if (now_ns_ - std::max(heartbeat_ns_, arming_since_ns_) > ns(3 * device_.heartbeat_every_s)) {
    lost_ = true;
    return fail("the drive sends no heartbeat any more: it may have restarted", {},
                "restart hapticd");
  }
  armed_ = armed_ || running();
  const auto raw = cia402::torque_raw(armed_ ? torque_Nm : 0, rated_Nm_);
  outbox.add(cia402::rpdo1(options_.node, next_control(), raw.value_or(0)));
  carried_Nm_ = armed_ ? 1e-3 * rated_Nm_ * raw.value_or(0) : 0;
  if (!armed_ && now_ns_ - arming_since_ns_ > kEnable_ns)
    fail("the drive did not reach operation enabled within two seconds, it is",
         cia402::word_of(state_));
}

void Cia402Drive::stop(bool must, Outbox& outbox) noexcept {
  control_ = kSwitchOff;
  // As long as it says that it runs, too: a frame may have been lost.
  if (must || running()) outbox.add(cia402::rpdo1(options_.node, kSwitchOff, 0));
}

}  // namespace hapticd::can
