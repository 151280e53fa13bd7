#include "sim/can/moteus_drive.h"

#include <algorithm>
#include <cmath>

namespace hapticd::sim::can {
namespace {

constexpr std::uint8_t kMoteusNoRegister = 1, kMoteusRefused = 2;  // codes of 0x30, 0x31

bool is_running(MoteusMode mode) {
  return mode == MoteusMode::position || mode == MoteusMode::zero_velocity ||
         mode == MoteusMode::stay_within;
}

bool is_calibrating(MoteusMode mode) {
  return mode >= MoteusMode::enabling && mode <= MoteusMode::calibrated;
}

bool is_latched(MoteusMode mode) {
  return mode == MoteusMode::fault || mode == MoteusMode::timeout;
}

bool can_be_commanded(double mode) {
  return mode == 0 || (mode >= 5 && mode <= 10) || mode == 12 || mode == 13 || mode == 15;
}

}  // namespace

MoteusDrive::MoteusDrive(const MoteusOptions& options, std::int64_t start_ns)
    : options_(options), clock_(options.clock_drift) {
  reset(start_ns);
}

void MoteusDrive::reset(std::int64_t now_ns) {
  staged_ = command_ = {};
  fault_ = 0;
  setpoint_ = integral_Nm_ = 0;
  boot_ns_ = time_ns_ = commanded_ns_ = now_ns;
  enter(MoteusMode::stopped, now_ns);
}

void MoteusDrive::enter(MoteusMode mode, std::int64_t now_ns) {
  mode_ = mode;
  entered_ns_ = now_ns;
  if (mode == MoteusMode::enabling) calibrating_ns_ = now_ns;
}

bool MoteusDrive::enabled() const {
  return is_running(mode_);
}

int MoteusDrive::fault() const {
  return mode_ == MoteusMode::fault ? fault_ : limited().code;
}

void MoteusDrive::fail(int code, std::int64_t now_ns) {
  fault_ = code;
  enter(MoteusMode::fault, now_ns);
}

// -- time

std::int64_t MoteusDrive::mode_end_ns() const {
  if (is_calibrating(mode_)) {
    const double third = static_cast<double>(mode_) - 1;  // modes 2, 3, 4
    return clock_.end_ns(calibrating_ns_, options_.calibrating_s * third / 3);
  }
  if (mode_ != MoteusMode::position && mode_ != MoteusMode::stay_within) return kNever;
  const double timeout_s =
      command_.timeout_s == 0 ? options_.default_timeout_s : command_.timeout_s;
  return clock_.end_ns(std::max(commanded_ns_, entered_ns_), timeout_s < 0 ? 0 : timeout_s);
}

std::int64_t MoteusDrive::next_ns() const {
  return mode_end_ns();
}

void MoteusDrive::advance(std::int64_t now_ns) {
  for (std::int64_t next = next_ns(); next <= now_ns; next = next_ns()) {
    run(next);
    end_mode(next);
  }
  run(now_ns);
}

void MoteusDrive::end_mode(std::int64_t now_ns) {
  switch (mode_) {
    case MoteusMode::enabling:
      return enter(MoteusMode::calibrating, now_ns);
    case MoteusMode::calibrating:
      return enter(MoteusMode::calibrated, now_ns);
    case MoteusMode::calibrated:
      if (outside()) return fail(kOutsideLimit, now_ns);
      enter(target_, now_ns);
      integral_Nm_ = 0;
      setpoint_ = turns_;
      return aim();
    default:
      return enter(MoteusMode::timeout, now_ns);
  }
}

// The setpoint moves with the commanded velocity, the integrator integrates.
void MoteusDrive::run(std::int64_t now_ns) {
  const double passed_s = clock_.own_s(std::max<std::int64_t>(now_ns - time_ns_, 0));
  time_ns_ = std::max(now_ns, time_ns_);
  if (mode_ != MoteusMode::position) return;
  if (std::isfinite(command_.velocity)) setpoint_ += command_.velocity * passed_s;
  const double most_Nm = kIlimit_Nm * std::abs(command_.ilimit_scale);
  integral_Nm_ =
      std::clamp(integral_Nm_ + kKi_Nm_s * (setpoint_ - turns_) * passed_s, -most_Nm, most_Nm);
}

// -- subframes: the reply tells the state before the frame's own command acts

void MoteusDrive::receive(const Frame& frame, std::int64_t now_ns) {
  if (is_rtr(frame) || is_error(frame)) return;
  const MoteusId id = moteus_id(id_of(frame));
  const bool mine = id.destination == options_.servo || id.destination == kMoteusBroadcast;
  if (!mine || id.prefix != options_.prefix) return;
  run(now_ns);
  std::vector<std::uint8_t> reply;
  bool commanded = false;
  for (const MoteusBlock& block : moteus_subframes(payload(frame)).blocks) {
    if (block.kind == MoteusBlock::Kind::write) commanded |= write(block, reply);
    if (block.kind == MoteusBlock::Kind::read) read(block, reply);
  }
  if (commanded) obey(now_ns);
  if (id.reply) answer(frame, reply, now_ns);
}

// Returns whether the block began a new command.
bool MoteusDrive::write(const MoteusBlock& block, std::vector<std::uint8_t>& reply) {
  bool commanded = false;
  for (std::uint32_t i = 0; i < block.count; ++i) {
    const std::uint32_t reg = block.first + i;
    if (reg == 0 && !can_be_commanded(block.values[i])) {
      moteus_append_error(MoteusBlock::Kind::write_error, reg, kMoteusRefused, reply);
      continue;
    }
    if (reg == 0) {
      staged_ = {};
      commanded = true;
    }
    if (double* field = moteus_field(staged_, reg)) {
      *field = block.values[i];
    } else {
      moteus_append_error(MoteusBlock::Kind::write_error, reg, kMoteusNoRegister, reply);
    }
  }
  return commanded;
}

void MoteusDrive::read(const MoteusBlock& block, std::vector<std::uint8_t>& reply) const {
  MoteusBlock known{.kind = MoteusBlock::Kind::reply, .type = block.type, .first = block.first};
  for (std::uint32_t reg = block.first; reg < block.first + block.count; ++reg) {
    if (const std::optional<double> found = value(reg)) {
      known.values.push_back(*found);
      continue;
    }
    moteus_append_reply(known, reply);
    moteus_append_error(MoteusBlock::Kind::read_error, reg, kMoteusNoRegister, reply);
    known.first = reg + 1;
    known.values.clear();
  }
  moteus_append_reply(known, reply);
}

void MoteusDrive::answer(const Frame& query, const std::vector<std::uint8_t>& reply,
                         std::int64_t now_ns) {
  if (reply.empty() || reply.size() > CANFD_MAX_DLEN) return;
  const bool classic = !is_fd(query) && reply.size() <= CAN_MAX_DLEN;
  const auto flags = static_cast<std::uint8_t>(classic ? 0 : CANFD_FDF | (query.flags & CANFD_BRS));
  const std::uint32_t id = moteus_reply_can_id(moteus_id(id_of(query)), options_.servo);
  send(clock_.end_ns(now_ns, options_.turnaround_s), moteus_frame(id, reply, flags));
}

// -- modes

void MoteusDrive::obey(std::int64_t now_ns) {
  const auto wanted = static_cast<MoteusMode>(staged_.mode);
  if (is_latched(mode_) && wanted != MoteusMode::stopped) return;
  command_ = staged_;
  commanded_ns_ = now_ns;
  target_ = wanted;
  if (!std::isfinite(command_.feedforward_Nm)) return fail(kPositionInvalid, now_ns);
  if (wanted == MoteusMode::stopped || wanted == MoteusMode::brake) return enter(wanted, now_ns);
  if (is_calibrating(mode_)) return;
  if (mode_ == MoteusMode::stopped || mode_ == MoteusMode::brake)
    return enter(MoteusMode::enabling, now_ns);
  if (mode_ != wanted) {
    integral_Nm_ = 0;
    setpoint_ = turns_;
    enter(wanted, now_ns);
  }
  aim();
}

// NaN: the setpoint stays, which was the position when the mode was entered.
void MoteusDrive::aim() {
  if (!std::isnan(command_.position)) setpoint_ = command_.position;
}

bool MoteusDrive::outside() const {
  if (command_.ignore_bounds != 0) return false;
  if (target_ != MoteusMode::position && target_ != MoteusMode::stay_within) return false;
  return turns_ < options_.position_min || turns_ > options_.position_max;
}

// -- motor

void MoteusDrive::move_to(double turns, double turns_s) {
  turns_ = turns;
  turns_s_ = turns_s;
}

double MoteusDrive::held_Nm(double target) const {
  return kKp_Nm * command_.kp_scale * (target - turns_) +
         kKd_Nms * command_.kd_scale *
             ((std::isfinite(command_.velocity) ? command_.velocity : 0) - turns_s_);
}

double MoteusDrive::wanted_Nm() const {
  const double damping_Nm = -kKd_Nms * turns_s_;
  switch (mode_) {
    case MoteusMode::position:
      return command_.feedforward_Nm + held_Nm(setpoint_) + integral_Nm_;
    case MoteusMode::stay_within:
      if (turns_ < command_.lower) return command_.feedforward_Nm + held_Nm(command_.lower);
      if (turns_ > command_.upper) return command_.feedforward_Nm + held_Nm(command_.upper);
      return command_.feedforward_Nm;
    case MoteusMode::zero_velocity:
      return command_.kd_scale * damping_Nm;
    case MoteusMode::timeout:
      return options_.timeout_mode == 12 ? std::clamp(damping_Nm, -5.0, 5.0) : 0;
    default:
      return 0;
  }
}

MoteusDrive::Limited MoteusDrive::limited() const {
  Limited out{wanted_Nm(), 0};
  if (std::isnan(out.torque_Nm)) out.torque_Nm = 0;  // of scales and bounds that are no numbers
  if (!is_running(mode_)) return out;
  const auto clip = [&](double most_Nm, int code) {
    if (!(std::abs(out.torque_Nm) > most_Nm)) return;
    out = {std::copysign(most_Nm, out.torque_Nm), code};
  };
  clip(options_.max_torque_Nm, kLimitCurrent);
  clip(std::abs(command_.max_torque_Nm), kLimitTorque);
  const bool beyond = (turns_ > options_.position_max && out.torque_Nm > 0) ||
                      (turns_ < options_.position_min && out.torque_Nm < 0);
  if (beyond && command_.ignore_bounds == 0) out = {0, kLimitPosition};
  return out;
}

// -- registers

double MoteusDrive::counted_turns() const {
  return std::floor(turns_ * options_.counts_per_turn) / options_.counts_per_turn;
}

std::optional<double> MoteusDrive::value(std::uint32_t reg) const {
  constexpr double kTorqueConstant_Nm_A = 0.1, kTurn = 6.283185307179586;
  constexpr double kFloatWraps_ms = 8388608;
  const double torque = torque_Nm();
  switch (reg) {
    case 0x000:
      return static_cast<double>(mode_);
    case 0x001:
    case 0x006:
      return counted_turns();
    case 0x002:
      return turns_s_;
    case 0x003:
      return torque;
    case 0x004:
      return torque / kTorqueConstant_Nm_A;
    case 0x005:
      return 0;
    case 0x007:
      return torque * turns_s_ * kTurn;
    case 0x00a:
      return 40;
    case 0x00b:
    case 0x00c:
      return 0;
    case 0x00d:
      return 24;
    case 0x00e:
      return 26;
    case 0x00f:
      return fault();
    case 0x070:
      return std::fmod(std::floor(1e3 * clock_.own_s(time_ns_ - boot_ns_)), kFloatWraps_ms);
    case 0x100:
      return 0x40;
    case 0x101:
      return 0x10000;
    case 0x102:
      return options_.register_map_version;
    case 0x120:
    case 0x121:
    case 0x122:
      return static_cast<std::int32_t>(options_.serial[reg - 0x120]);
    default:
      break;
  }
  MoteusCommand registers = staged_;
  const double* field = moteus_field(registers, reg);
  return field != nullptr ? std::optional(*field) : std::nullopt;
}

}  // namespace hapticd::sim::can
