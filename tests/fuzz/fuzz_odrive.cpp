// ODrive's frames: what is decoded is in the bytes, what is encoded can be read again, and the
// drive's state machine never arms or pulls when it must not.
#include "drivers/can/odrive_codec.h"
#include "drivers/can/odrive_drive.h"
#include "sim/can/odrive_drive.h"
#include "tests/fuzz/protocol.h"
#include "tests/fuzz/session.h"

namespace hapticd::fuzz {
namespace {

namespace odrive = can::odrive;
using odrive::Received;

constexpr std::uint32_t kFromDrive[] = {0x00, 0x01, 0x03, 0x09, 0x14, 0x15, 0x17, 0x1c};
constexpr std::uint32_t kFromHost[] = {0x02, 0x07, 0x0b, 0x0c, 0x0d, 0x0e, 0x0f, 0x16, 0x18};

template <class Set>
bool is_in(const Set& set, std::uint32_t command) {
  return std::find(std::begin(set), std::end(set), command) != std::end(set);
}

class OdriveWire final : public Wire {
 public:
  explicit OdriveWire(std::uint8_t node) : node_(node) {}

  void own(can::Frame& frame, std::uint32_t number) const override {
    frame.id = (std::uint32_t{node_} << 5) | (number & 0x1f);
  }
  std::optional<double> torque_of(const can::Frame& frame) const override {
    if (frame.id != (std::uint32_t{node_} << 5 | 0x0e)) return std::nullopt;
    must(frame.size == 4 && !frame.fd && !frame.extended && !frame.remote, "a torque has 4 bytes");
    return static_cast<double>(can::get<float>(frame.payload(), 0));
  }
  double tolerance_Nm(double wanted) const override {
    return std::ldexp(std::abs(wanted), -24) + std::numeric_limits<float>::denorm_min();
  }

 private:
  std::uint8_t node_;
};

/// Of an accepted message that is two floats.
void check_floats(const odrive::Message& message, const can::Frame& frame) {
  const auto in_frame = [&](float first, float second, bool may_be_nan) {
    const float both[] = {first, second};
    must(std::memcmp(both, frame.data.data(), sizeof both) == 0, "the floats are those sent");
    for (const float one : both)
      must(may_be_nan ? !std::isinf(one) : std::isfinite(one), "a value is a number");
  };
  if (const auto* m = std::get_if<odrive::Estimates>(&message))
    in_frame(m->position_turns, m->velocity_turns_s, false);
  if (const auto* m = std::get_if<odrive::Currents>(&message))
    in_frame(m->setpoint_A, m->measured_A, false);
  if (const auto* m = std::get_if<odrive::Temperatures>(&message))
    in_frame(m->fet_C, m->motor_C, true);
  if (const auto* m = std::get_if<odrive::Supply>(&message))
    in_frame(m->voltage_V, m->current_A, false);
  if (const auto* m = std::get_if<odrive::Torques>(&message))
    in_frame(m->target_Nm, m->estimate_Nm, false);
}

void check_accepted(const odrive::Message& message, const can::Frame& frame) {
  const std::uint32_t command = frame.id & 0x1f;
  must(!frame.error && !frame.remote && !frame.fd && frame.size == 8, "it is a whole message");
  must(message.index() > 0 && command == kFromDrive[message.index() - 1], "the message of its id");
  check_floats(message, frame);
  if (const auto* m = std::get_if<odrive::Heartbeat>(&message)) {
    must(m->error == can::get<std::uint32_t>(frame.payload(), 0), "the error is the one sent");
    must(m->state == frame.data[4] && m->procedure_result == frame.data[5], "so is the state");
  }
}

}  // namespace

void decode(Input& input) {
  const auto node = static_cast<std::uint8_t>(input.byte() % (odrive::kMaxNode + 1));
  const OdriveWire wire(node);
  const can::Frame frame =
      frame_of(input, [&](auto& own, std::uint32_t number) { wire.own(own, number); });
  must(odrive::error_word(frame.data[0]).size() < 64, "a word of an error");
  const odrive::Decoded decoded = odrive::decode(frame, node);
  const bool mine = !frame.extended && frame.id >> 5 == node;
  must((decoded.received == Received::error_frame) == frame.error, "error frames are such");
  if (decoded.received != Received::ok)
    must(decoded.message.index() == 0, "only what is accepted has a message");
  switch (decoded.received) {
    case Received::ok:
      must(mine, "it is of this node");
      return check_accepted(decoded.message, frame);
    case Received::malformed:
      return must(mine && is_in(kFromDrive, frame.id & 0x1f) && frame.size < 8, "it is short");
    case Received::non_finite:
      return must(!std::isfinite(can::get<float>(frame.payload(), 0)) ||
                      !std::isfinite(can::get<float>(frame.payload(), 4)),
                  "a value is no number");
    case Received::other_master:
      return must(mine && is_in(kFromHost, frame.id & 0x1f), "it is a host's command");
    case Received::ignore:
      return must(!mine || frame.remote || frame.fd ||
                      (!is_in(kFromDrive, frame.id & 0x1f) && !is_in(kFromHost, frame.id & 0x1f)),
                  "nothing that is used is ignored");
    case Received::error_frame:
      return;
  }
  must(false, "a verdict that there is");
}

namespace {

/// A value and a frame that should carry it as two or three fields.
template <class... Values>
bool must_be_sent(const std::optional<can::Frame>& frame, std::uint32_t id, Values... values) {
  must(frame.has_value() == (is_single(values) && ...), "refused where a value is no number");
  if (!frame) return false;
  must_be_legal(*frame);
  must(frame->id == id && !frame->extended && !frame->fd && !frame->remote, "the id of the node");
  return true;
}

void must_be_steps(const can::Frame& frame, std::size_t at, double wanted) {
  constexpr double kStep = 0.001F;
  const double found = kStep * can::get<std::int16_t>(frame.payload(), at);
  const double clamped = std::clamp(wanted, -32767 * kStep, 32767 * kStep);
  must(std::abs(found - clamped) <= kStep, "within a step");
  must(std::abs(found) <= std::abs(wanted) * (1 + 1e-12), "towards zero");
}

}  // namespace

void encode(Input& input) {
  const auto node = static_cast<std::uint8_t>(input.byte() % (odrive::kMaxNode + 1));
  const std::uint32_t id = std::uint32_t{node} << 5;
  const double a = input.number(), b = input.number(), c = input.number();
  const auto is_float = [](const can::Frame& frame, std::size_t at, double wanted) {
    must(is_nearest(static_cast<double>(can::get<float>(frame.payload(), at)), wanted), "nearest");
  };
  if (const auto frame = odrive::set_input_torque(node, a); must_be_sent(frame, id | 0x0e, a))
    is_float(*frame, 0, a);
  for (const auto& [frame, command] : {std::pair{odrive::set_input_vel(node, a, b), 0x0du},
                                       std::pair{odrive::set_limits(node, a, b), 0x0fu}}) {
    if (!must_be_sent(frame, id | command, a, b)) continue;
    is_float(*frame, 0, a);
    is_float(*frame, 4, b);
  }
  if (const auto frame = odrive::set_input_pos(node, a, b, c);
      must_be_sent(frame, id | 0x0c, a, b, c)) {
    is_float(*frame, 0, a);
    must_be_steps(*frame, 4, b);
    must_be_steps(*frame, 6, c);
  }
}

void session(Input& input) {
  const std::uint8_t kind = input.byte();
  const auto node = static_cast<std::uint8_t>(input.byte() % (odrive::kMaxNode + 1));
  const bool free_running = (kind & 1) != 0;
  const can::DeviceOptions device{
      .timing = free_running ? drivers::Timing::free_running : drivers::Timing::in_phase,
      .heartbeat_every_s = 0.01};
  const can::DriveOptions options{.axis = "fuzz.x",
                                  .interface = "can0",
                                  .node = node,
                                  .counts_per_unit = (kind & 2) != 0 ? -1000.0 : 1000.0,
                                  .counts_per_turn = 16384,
                                  .max_velocity_turns_s = 20,
                                  .max_current_A = (kind & 4) != 0 ? 5.0 : 0.0};
  sim::can::OdriveDrive servo({.node = node,
                               .watchdog_enabled = (kind & 0x30) != 0x30,
                               .estimates_every_s = free_running ? 0.001 : 0,
                               .heartbeat_every_s = 0.01,
                               .heartbeat_on_change = (kind & 8) != 0},
                              1'000'000'000'000);
  can::OdriveDrive drive(device, options);
  run({input, drive, servo, OdriveWire(node), device});
}

}  // namespace hapticd::fuzz
