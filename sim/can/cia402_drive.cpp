#include "sim/can/cia402_drive.h"

#include <algorithm>
#include <cmath>

#include "sim/can/cia402_keys.h"

namespace hapticd::sim::can {
namespace {

constexpr std::uint8_t kLastSynchronous = 240;  // transmission type
constexpr std::uint16_t kRpdoTooShort = 0x8210;

// Generic, and by the group of the code: current, voltage, temperature, communication.
std::uint8_t error_register(std::uint16_t code) {
  if (code == 0) return 0;
  switch (code >> 12) {
    case 2:
      return 0x03;
    case 3:
      return 0x05;
    case 4:
      return 0x09;
    case 8:
      return 0x11;
    default:
      return 0x01;
  }
}

}  // namespace

Cia402Drive::Cia402Drive(const Cia402Options& options, std::int64_t start_ns)
    : options_(options), clock_(options.clock_drift) {
  boot(start_ns);
}

// -- dictionary

// What the drive itself knows goes into the dictionary, before anybody reads it.
void Cia402Drive::refresh() {
  const double counts = turns_ * options_.counts_per_rev;
  objects_.set(kErrorCode, error_code_);
  objects_.set(kErrorRegister, error_register(error_code_));
  objects_.set(kStatusword, statusword());
  objects_.set(kPosition, cia402_whole(counts));
  objects_.set(kVelocity, cia402_whole(turns_s_ * options_.counts_per_rev + 0.5));
  objects_.set(kTorque,
               static_cast<std::uint32_t>(cia402_per_mille(torque_Nm(), options_.rated_torque_Nm)));
}

// -- start

void Cia402Drive::reset(std::int64_t now_ns) {
  boot(now_ns);
}

void Cia402Drive::boot(std::int64_t now_ns) {
  add_objects();
  state_ = Cia402State::switch_on_disabled;
  last_control_ = error_code_ = 0;
  boot_communication(now_ns);
}

void Cia402Drive::boot_communication(std::int64_t now_ns) {
  heard_host_ns_.reset();
  held_rpdos_ = {};
  syncs_ = 0;
  sdo_free_ns_ = now_ns;
  set_nmt(NmtState::pre_operational);
  send(now_ns, canopen_heartbeat(options_.node, NmtState::boot_up));
  write(kProducerHeartbeat, objects_[kProducerHeartbeat], now_ns);
}

// -- time

std::int64_t Cia402Drive::host_lost_ns() const {
  const std::uint32_t time_ms = objects_[kConsumerHeartbeat] & 0xffff;
  if (!heard_host_ns_ || time_ms == 0) return kNever;
  return clock_.end_ns(*heard_host_ns_, 1e-3 * time_ms);
}

std::int64_t Cia402Drive::next_ns() const {
  return std::min(heartbeats_.next_ns(), host_lost_ns());
}

void Cia402Drive::advance(std::int64_t now_ns) {
  for (std::int64_t next = next_ns(); next <= now_ns; next = next_ns()) {
    if (host_lost_ns() == next) {
      lose_host(next);
    } else {
      send(next, canopen_heartbeat(options_.node, nmt_));
      heartbeats_.done();
    }
  }
}

// Waits for the next heartbeat before it counts again. Abort connection option 0: the motor goes
// on.
void Cia402Drive::lose_host(std::int64_t now_ns) {
  heard_host_ns_.reset();
  if (nmt_ != NmtState::operational) return;
  if (objects_[kAbortOption] == 0) {
    emergency(kHeartbeatLost, now_ns);
  } else {
    fail(kHeartbeatLost, now_ns);
  }
  if (options_.pre_operational_on_loss) set_nmt(NmtState::pre_operational);
}

// -- frames

void Cia402Drive::receive(const Frame& frame, std::int64_t now_ns) {
  if (!is_plain(frame) || is_rtr(frame)) return;
  if (const auto command = nmt_command(frame, options_.node)) return obey_nmt(*command, now_ns);
  hear_heartbeat(frame, now_ns);
  if (nmt_ == NmtState::stopped) return;
  if (const auto request = sdo_request(frame, options_.node)) return serve(*request, now_ns);
  if (nmt_ != NmtState::operational) return;
  if (id_of(frame) == kCanopenSync) return sync(now_ns);
  hear_rpdo(frame, now_ns);
}

void Cia402Drive::hear_heartbeat(const Frame& frame, std::int64_t now_ns) {
  const std::uint32_t producer = (objects_[kConsumerHeartbeat] >> 16) & 0x7f;
  if (producer == 0 || id_of(frame) != kCanopenHeartbeat + producer || frame.len != 1) return;
  heard_host_ns_ = now_ns;
}

void Cia402Drive::obey_nmt(NmtCommand command, std::int64_t now_ns) {
  switch (command) {
    case NmtCommand::start:
      return set_nmt(NmtState::operational);
    case NmtCommand::stop:
      return set_nmt(NmtState::stopped);
    case NmtCommand::pre_operational:
      return set_nmt(NmtState::pre_operational);
    case NmtCommand::reset_node:
      return boot(now_ns);
    case NmtCommand::reset_communication: {
      const Cia402Objects before = objects_;
      add_objects();
      for (const std::uint32_t key : {kAbortOption, kMode, kModeDisplay, kTargetTorque, kMaxTorque})
        objects_.set(key, before[key]);
      return boot_communication(now_ns);
    }
  }
}

// A motor that runs is switched off on the way out of operational.
void Cia402Drive::set_nmt(NmtState state) {
  const bool ran = state_ == Cia402State::operation_enabled;
  if (state != NmtState::operational && ran) state_ = Cia402State::switch_on_disabled;
  if (state != nmt_) held_rpdos_ = {};
  nmt_ = state;
}

// -- SDO

void Cia402Drive::serve(const SdoRequest& request, std::int64_t now_ns) {
  sdo_free_ns_ = clock_.end_ns(std::max(sdo_free_ns_, now_ns), options_.sdo_delay_s);
  send(sdo_free_ns_, sdo_answer(request, now_ns));
}

Frame Cia402Drive::sdo_answer(const SdoRequest& request, std::int64_t now_ns) {
  const std::uint8_t node = options_.node;
  const auto [kind, index, sub, value, size] = request;
  const std::uint32_t key = object_key(index, sub);
  if (kind == SdoRequest::Kind::other) return sdo_abort(node, index, sub, sdo::kUnknownCommand);
  if (kind == SdoRequest::Kind::read) {
    refresh();
    if (const Cia402Object* object = objects_.find(key))
      return sdo_value(node, index, sub, object->value, object->size);
    return sdo_abort(node, index, sub,
                     objects_.has_index(index) ? sdo::kNoSubIndex : sdo::kNoObject);
  }
  std::uint32_t wrong = objects_.problem(key, value, size);
  if (wrong == 0) wrong = value_problem(key, value);
  if (wrong != 0) return sdo_abort(node, index, sub, wrong);
  write(key, value, now_ns);
  return sdo_written(node, index, sub);
}

std::uint32_t Cia402Drive::value_problem(std::uint32_t key, std::uint32_t value) const {
  if (key != kMode) return 0;
  const bool known = value == 0 || value == 1 || value == 3;
  return known || (value == kCst && options_.supports_cst) ? 0 : sdo::kValueRange;
}

// What follows from a value that has been accepted.
void Cia402Drive::write(std::uint32_t key, std::uint32_t value, std::int64_t now_ns) {
  if (value_problem(key, value) != 0) return;  // over PDO nobody is told
  objects_.set(key, value);
  if (key == kControlword) control(static_cast<std::uint16_t>(value), now_ns);
  if (key == kMode) objects_.set(kModeDisplay, value);
  if (key == kConsumerHeartbeat) heard_host_ns_.reset();
  if (key == kProducerHeartbeat) {
    const double period_ns = clock_.ns(1e-3 * objects_[key]);
    heartbeats_ = Cycle(now_ns + std::llround(period_ns), period_ns);
  }
}

// -- PDO

void Cia402Drive::hear_rpdo(const Frame& frame, std::int64_t now_ns) {
  for (std::uint32_t i = 0; i < Cia402Objects::kPdos; ++i) {
    const Cia402Objects::Pdo pdo = objects_.rpdo(i);
    if (!pdo.enabled || pdo.id != id_of(frame)) continue;
    if (8U * frame.len < pdo.bits()) {
      emergency(kRpdoTooShort, now_ns);
    } else if (pdo.type <= kLastSynchronous) {
      held_rpdos_[i] = frame;
    } else {
      take_rpdo(i, frame, now_ns);
    }
  }
}

void Cia402Drive::take_rpdo(std::uint32_t pdo, const Frame& frame, std::int64_t now_ns) {
  std::size_t at = 0;
  for (const std::uint32_t entry : objects_.rpdo(pdo).mapped) {
    const std::uint32_t bits = entry & 0xff;
    write(entry >> 8, pdo_get(frame, at, bits), now_ns);
    at += bits;
  }
}

// Measured first, then moved on with what came since the last SYNC.
void Cia402Drive::sync(std::int64_t now_ns) {
  ++syncs_;
  send_tpdos(now_ns);
  for (std::uint32_t i = 0; i < Cia402Objects::kPdos; ++i) {
    if (!held_rpdos_[i]) continue;
    take_rpdo(i, *held_rpdos_[i], now_ns);
    held_rpdos_[i].reset();
  }
}

void Cia402Drive::send_tpdos(std::int64_t now_ns) {
  refresh();
  for (std::uint32_t i = 0; i < Cia402Objects::kPdos; ++i) {
    const Cia402Objects::Pdo pdo = objects_.tpdo(i);
    if (!pdo.enabled || pdo.type > kLastSynchronous) continue;
    if (pdo.type > 1 && syncs_ % pdo.type != 0) continue;
    Frame frame = classic_frame(pdo.id, 0);
    std::size_t at = 0;
    for (const std::uint32_t entry : pdo.mapped)
      at = pdo_put(frame, at, objects_[entry >> 8], entry & 0xff);
    send(clock_.end_ns(now_ns, options_.turnaround_s), frame);
  }
}

// -- state machine

void Cia402Drive::control(std::uint16_t word, std::int64_t now_ns) {
  const bool failed = state_ == Cia402State::fault;
  state_ = cia402_next(state_, word, last_control_);
  last_control_ = word;
  if (!failed || state_ == Cia402State::fault) return;
  error_code_ = 0;
  emergency(0, now_ns);
}

void Cia402Drive::fail(int code, std::int64_t now_ns) {
  state_ = Cia402State::fault;
  error_code_ = static_cast<std::uint16_t>(code);
  emergency(error_code_, now_ns);
}

void Cia402Drive::emergency(std::uint16_t code, std::int64_t now_ns) {
  if (nmt_ == NmtState::stopped) return;
  send(now_ns, canopen_emcy(options_.node, code, error_register(code)));
}

std::uint16_t Cia402Drive::statusword() const {
  const bool runs = enabled();
  return cia402_statusword({.state = state_,
                            .internal_limit = runs && std::abs(target_Nm()) > most_Nm(),
                            .target_followed = runs});
}

// -- motor

bool Cia402Drive::enabled() const {
  return state_ == Cia402State::operation_enabled && nmt_ == NmtState::operational &&
         objects_[kModeDisplay] == kCst;
}

double Cia402Drive::target_Nm() const {
  const auto per_mille = static_cast<std::int16_t>(objects_[kTargetTorque]);
  return 1e-3 * per_mille * options_.rated_torque_Nm;
}

double Cia402Drive::most_Nm() const {
  return std::min(options_.max_torque_Nm, 1e-3 * objects_[kMaxTorque] * options_.rated_torque_Nm);
}

double Cia402Drive::clipped_Nm() const {
  return std::clamp(target_Nm(), -most_Nm(), most_Nm());
}

void Cia402Drive::move_to(double turns, double turns_s) {
  turns_ = turns;
  turns_s_ = turns_s;
}

}  // namespace hapticd::sim::can
