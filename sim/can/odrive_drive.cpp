#include "sim/can/odrive_drive.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::sim::can {
namespace {

constexpr double kOdriveTorqueConstant_Nm_A = 0.1;
constexpr double kOdriveBus_V = 24;
constexpr std::uint8_t kOdriveDisarmed = 3;  // procedure result
constexpr double kTurn_rad = 6.283185307179586;

}  // namespace

OdriveDrive::OdriveDrive(const OdriveOptions& options, std::int64_t start_ns)
    : options_(options), clock_(options.clock_drift), node_(options.node) {
  reset(start_ns);
}

void OdriveDrive::reset(std::int64_t now_ns) {
  const std::int64_t first_ns = clock_.end_ns(now_ns, options_.start_phase_s);
  heartbeats_ = Cycle(first_ns, clock_.ns(options_.heartbeat_every_s));
  estimates_ = Cycle(first_ns, clock_.ns(options_.estimates_every_s));
  state_ = kIdle;
  result_ = 0;
  errors_ = disarm_reason_ = 0;
  mode_ = {3, 1};
  limits_ = {};
  input_Nm_ = 0;
  was_closed_loop_ = false;
}

// -- time

std::int64_t OdriveDrive::watchdog_ns() const {
  if (!options_.watchdog_enabled || state_ != kClosedLoop) return kNever;
  return clock_.end_ns(fed_ns_, options_.watchdog_s);
}

std::int64_t OdriveDrive::next_ns() const {
  return std::min({heartbeats_.next_ns(), estimates_.next_ns(), watchdog_ns()});
}

void OdriveDrive::advance(std::int64_t now_ns) {
  for (std::int64_t next = next_ns(); next <= now_ns; next = next_ns()) {
    if (watchdog_ns() == next) {
      disarm(kWatchdogExpired, next);
    } else if (heartbeats_.next_ns() == next) {
      send(next, message(OdriveCommand::heartbeat));
      heartbeats_.done();
    } else {
      send(next, estimates());
      estimates_.done();
    }
  }
}

// -- orders

void OdriveDrive::receive(const Frame& frame, std::int64_t now_ns) {
  const std::optional<OdriveOrder> order = odrive_order(frame);
  if (!order) return;
  const bool address = std::holds_alternative<OdriveSetAddress>(*order) ||
                       (std::holds_alternative<OdriveAsk>(*order) &&
                        std::get<OdriveAsk>(*order).what == OdriveCommand::address);
  const std::uint8_t to = odrive_node(frame);
  if (to != node_ && !(address && to == kOdriveBroadcast)) return;
  std::visit([&](const auto& what) { obey(what, now_ns); }, *order);
}

void OdriveDrive::obey(const OdriveSetAxisState& order, std::int64_t now_ns) {
  if (order.state == kIdle) {
    state_ = kIdle;
    result_ = 0;
  } else if (order.state == kClosedLoop && errors_ != 0) {
    result_ = kOdriveDisarmed;
  } else if (order.state == kClosedLoop && state_ != kClosedLoop) {
    state_ = kClosedLoop;
    result_ = 0;
    disarm_reason_ = 0;
    fed_ns_ = now_ns;
    was_closed_loop_ = true;
  }
  changed(now_ns);
}

void OdriveDrive::obey(const OdriveSetControllerMode& order, std::int64_t) {
  mode_ = order;
}

void OdriveDrive::obey(const OdriveSetInputPos&, std::int64_t now_ns) {
  fed_ns_ = now_ns;
}

void OdriveDrive::obey(const OdriveSetInputVel&, std::int64_t now_ns) {
  fed_ns_ = now_ns;
}

void OdriveDrive::obey(const OdriveSetInputTorque& order, std::int64_t now_ns) {
  fed_ns_ = now_ns;
  if (std::isfinite(order.torque_Nm)) {
    input_Nm_ = order.torque_Nm;
  } else {
    disarm(kMissingInput, now_ns);
  }
}

void OdriveDrive::obey(const OdriveSetLimits& order, std::int64_t) {
  limits_ = order;
}

void OdriveDrive::obey(const OdriveClearErrors&, std::int64_t now_ns) {
  errors_ = disarm_reason_ = 0;
  if (state_ == kIdle) result_ = 0;
  changed(now_ns);
}

void OdriveDrive::obey(const OdriveEstop&, std::int64_t now_ns) {
  disarm(kEstopRequested, now_ns);
}

void OdriveDrive::obey(const OdriveReboot& order, std::int64_t now_ns) {
  if (order.action == 0) reset(now_ns);
}

void OdriveDrive::obey(const OdriveSetAddress& order, std::int64_t) {
  if (order.serial == options_.serial) node_ = order.node;
}

void OdriveDrive::obey(const OdriveAsk& order, std::int64_t now_ns) {
  send(clock_.end_ns(now_ns, options_.turnaround_s), message(order.what));
}

void OdriveDrive::fail(int code, std::int64_t now_ns) {
  disarm(static_cast<std::uint32_t>(code), now_ns);
}

void OdriveDrive::disarm(std::uint32_t errors, std::int64_t now_ns) {
  errors_ |= errors;
  disarm_reason_ = errors;
  state_ = kIdle;
  result_ = kOdriveDisarmed;
  changed(now_ns);
}

void OdriveDrive::changed(std::int64_t now_ns) {
  if (options_.heartbeat_on_change) send(now_ns, message(OdriveCommand::heartbeat));
}

// -- motor

double OdriveDrive::torque_Nm() const {
  return enabled() ? std::clamp(input_Nm_, -options_.max_torque_Nm, options_.max_torque_Nm) : 0;
}

void OdriveDrive::move_to(double turns, double turns_s) {
  turns_ = turns;
  turns_s_ = turns_s;
}

// -- messages

Frame OdriveDrive::message(OdriveCommand what) const {
  const double torque = torque_Nm(), current_A = torque / kOdriveTorqueConstant_Nm_A;
  const double power_W = torque * turns_s_ * kTurn_rad;
  switch (what) {
    case OdriveCommand::get_version:
      return odrive_version(node_, {.protocol = options_.protocol, .firmware = options_.firmware});
    case OdriveCommand::heartbeat:
      return odrive_heartbeat(node_, {errors_, state_, result_, false});
    case OdriveCommand::get_error:
      return odrive_error(node_, errors_, disarm_reason_);
    case OdriveCommand::address:
      return odrive_address(node_, options_.serial);
    case OdriveCommand::get_encoder_estimates:
      return estimates();
    case OdriveCommand::get_iq:
      return odrive_floats(node_, what, current_A, current_A);
    case OdriveCommand::get_temperature:
      return odrive_floats(node_, what, 31.5, 40);
    case OdriveCommand::get_bus_voltage_current:
      return odrive_floats(node_, what, kOdriveBus_V, power_W / kOdriveBus_V);
    case OdriveCommand::get_powers:
      return odrive_floats(node_, what, power_W, power_W);
    default:
      return odrive_floats(node_, OdriveCommand::get_torques, torque, torque);
  }
}

Frame OdriveDrive::estimates() const {
  const bool known = was_closed_loop_ || !options_.zero_until_closed_loop;
  const double counts = std::floor(turns_ * options_.counts_per_turn);
  return odrive_floats(node_, OdriveCommand::get_encoder_estimates,
                       known ? counts / options_.counts_per_turn : 0, known ? turns_s_ : 0);
}

}  // namespace hapticd::sim::can
