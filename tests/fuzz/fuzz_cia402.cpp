// CiA 402 over CANopen: what is decoded is in the bytes, what is encoded can be read again, and the
// drive's state machine never arms or pulls when it must not.
#include "drivers/can/cia402_codec.h"
#include "drivers/can/cia402_drive.h"
#include "sim/can/cia402_drive.h"
#include "tests/fuzz/protocol.h"
#include "tests/fuzz/session.h"

namespace hapticd::fuzz {
namespace {

namespace cia402 = can::cia402;
using cia402::Received;

constexpr std::uint16_t kEnable = 0x0f;

class Cia402Wire final : public Wire {
 public:
  Cia402Wire(std::uint8_t node, double rated_Nm) : node_(node), rated_Nm_(rated_Nm) {}

  void own(can::Frame& frame, std::uint32_t number) const override {
    constexpr std::uint32_t kCodes[] = {0x080, 0x180, 0x180, 0x280, 0x580, 0x700, 0x200, 0x600};
    frame.id = kCodes[number % 8] + node_;
    if ((number >> 8) % 64 == 63) frame.id = number & 0x080;  // NMT, SYNC
  }
  std::optional<double> torque_of(const can::Frame& frame) const override {
    if (frame.id != 0x200u + node_) return std::nullopt;
    must(frame.size == 4 && !frame.fd && !frame.extended && !frame.remote, "a PDO of 4 bytes");
    const int raw = can::get<std::int16_t>(frame.payload(), 2);
    must(raw == 0 || can::get<std::uint16_t>(frame.payload(), 0) == kEnable,
         "no torque to a drive that is not told to run");
    return 1e-3 * rated_Nm_ * raw;
  }
  double tolerance_Nm(double wanted) const override {
    return 1e-3 * rated_Nm_ * (0.5 + 1e-9) + std::max(0.0, std::abs(wanted) - 32.767 * rated_Nm_);
  }

 private:
  std::uint8_t node_;
  double rated_Nm_;
};

std::uint8_t node_from(Input& input) {
  return static_cast<std::uint8_t>(1 + input.byte() % cia402::kMaxNode);
}

void check_sdo(const cia402::SdoReply& sdo, const can::Frame& frame) {
  must(frame.size == 8 && sdo.object.index == (frame.data[1] | frame.data[2] << 8) &&
           sdo.object.sub == frame.data[3],
       "the object is the one sent");
  const std::uint8_t head = frame.data[0];
  switch (sdo.kind) {
    case cia402::SdoReply::Kind::written:
      return must(head == 0x60, "an object was written");
    case cia402::SdoReply::Kind::aborted:
      return must(head == 0x80, "an abort");
    case cia402::SdoReply::Kind::read:
      must(head == 0x4f || head == 0x4b || head == 0x47 || head == 0x43, "a value of a known size");
      must(sdo.size == (head == 0x4f   ? 1
                        : head == 0x4b ? 2
                        : head == 0x47 ? 3
                                       : 4),
           "of that size");
      return must(sdo.size == 4 || sdo.value < 1u << 8 * sdo.size, "no larger than its size");
  }
  must(false, "a kind that there is");
}

void check_status(std::uint16_t status) {
  const cia402::State state = cia402::state_of(status);
  must(state <= cia402::State::fault && !cia402::word_of(state).empty(), "a state that there is");
  must((state == cia402::State::operation_enabled) == ((status & 0x6f) == 0x27), "it runs, or not");
  const std::uint16_t next = cia402::towards_enabled(state);
  must(next == 0 || next == 6 || next == 7 || next == kEnable || next == 0x80, "a control word");
}

void check_accepted(const cia402::Decoded& decoded, const can::Frame& frame, std::uint8_t node) {
  const auto b = frame.payload();
  const std::uint32_t code = frame.id - node;
  must(!frame.error && !frame.extended && !frame.remote && !frame.fd && (frame.id & 0x7f) == node,
       "it is of this node");
  must(decoded.tpdo1.has_value() + decoded.tpdo2.has_value() + decoded.emergency.has_value() +
               decoded.guard.has_value() + decoded.sdo.has_value() ==
           1,
       "one message");
  if (const auto& m = decoded.tpdo1) {
    must(code == 0x180 && b.size() == 8, "a whole PDO");
    must(m->status == can::get<std::uint16_t>(b, 0) && m->torque == can::get<std::int16_t>(b, 6) &&
             m->position == can::get<std::int32_t>(b, 2),
         "as it was sent");
    check_status(m->status);
  }
  if (const auto& m = decoded.tpdo2)
    must(code == 0x280 && b.size() >= 7 && m->error == can::get<std::uint16_t>(b, 4), "a PDO");
  if (const auto& m = decoded.emergency)
    must(code == 0x080 && b.size() == 8 && m->code == can::get<std::uint16_t>(b, 0) &&
             m->vendor[4] == b[7],
         "an emergency");
  if (const auto& m = decoded.guard) {
    must(code == 0x700 && !b.empty() && static_cast<int>(m->state) == (b[0] & 0x7f), "a heartbeat");
    must(!cia402::word_of(m->state).empty(), "a word for any state");
  }
  if (const auto& m = decoded.sdo) {
    must(code == 0x580, "an answer");
    check_sdo(*m, frame);
  }
}

}  // namespace

void decode(Input& input) {
  const std::uint8_t node = node_from(input);
  const Cia402Wire wire(node, 1);
  const can::Frame frame =
      frame_of(input, [&](auto& own, std::uint32_t number) { wire.own(own, number); });
  const cia402::Decoded decoded = cia402::decode(frame, node);
  must(!(cia402::is_sync(frame) && cia402::is_nmt(frame, node)), "one of them");
  must((decoded.received == Received::error_frame) == frame.error, "error frames are such");
  must(decoded.received <= Received::error_frame, "a verdict that there is");
  if (decoded.received == Received::ok) return check_accepted(decoded, frame, node);
  must(!decoded.tpdo1 && !decoded.tpdo2 && !decoded.emergency && !decoded.guard && !decoded.sdo,
       "only what is accepted has a message");
}

namespace {

void check_torque(double torque_Nm, double rated_Nm) {
  const auto raw = cia402::torque_raw(torque_Nm, rated_Nm);
  const double steps = 1000 * torque_Nm / rated_Nm;
  must(raw.has_value() == (std::isfinite(torque_Nm) && rated_Nm > 0 && !std::isnan(steps)),
       "refused if no number");
  if (!raw) return;
  // Half a step, or saturated; what is scaled first may round once.
  const double clamped = std::clamp(steps, -32768.0, 32767.0);
  must(std::abs(*raw - clamped) <= 0.5, "within half a step");
  const can::Frame frame = cia402::rpdo1(1, kEnable, *raw);
  must_be_legal(frame);
  must(can::get<std::int16_t>(frame.payload(), 2) == *raw, "as it was asked for");
}

void check_sdo_write(Input& input, std::uint8_t node) {
  const auto value = input.take<std::int64_t>();
  const cia402::Object object{input.take<std::uint16_t>(), input.byte()};
  const int size = static_cast<std::int8_t>(input.byte());
  const auto frame = cia402::sdo_write(node, object, value, size);
  const bool size_is_good = size >= 1 && size <= 4;
  const std::int64_t most = size_is_good ? std::int64_t{1} << 8 * size : 0;
  must(frame.has_value() == (size_is_good && value >= -most / 2 && value < most), "what fits");
  if (!frame) return;
  must_be_legal(*frame);
  std::uint32_t sent = 0;
  std::memcpy(&sent, frame->data.data() + 4, static_cast<std::size_t>(size));
  must(sent == (static_cast<std::uint64_t>(value) & static_cast<std::uint64_t>(most - 1)), "as is");
  must(frame->size == 8 && frame->id == 0x600u + node, "a request to the node");
}

}  // namespace

void encode(Input& input) {
  const std::uint8_t node = node_from(input);
  const double torque_Nm = input.number();
  check_torque(torque_Nm, input.number());
  check_sdo_write(input, node);
  must_be_legal(cia402::rpdo1(node, input.take<std::uint16_t>(), input.take<std::int16_t>()));
  check_status(input.take<std::uint16_t>());
  must(cia402::emergency_word(input.take<std::uint16_t>()).size() < 64, "a word of a code");
}

void session(Input& input) {
  const std::uint8_t kind = input.byte();
  const auto node = static_cast<std::uint8_t>(1 + input.byte() % 126);
  constexpr double kRated_Nm = 0.5, kCounts = 65536;
  const can::DeviceOptions device{
      .timing = drivers::Timing::in_phase, .heartbeat_every_s = 0.05, .host_node = 127};
  const can::DriveOptions options{.axis = "fuzz.x",
                                  .interface = "can0",
                                  .node = node,
                                  .counts_per_unit = (kind & 2) != 0 ? -1000.0 : 1000.0,
                                  .counts_per_turn = kCounts};
  sim::can::Cia402Drive servo({.node = node,
                               .rated_torque_Nm = kRated_Nm,
                               .counts_per_rev = kCounts,
                               .supports_cst = (kind & 0x70) != 0x70,
                               .sdo_delay_s = 1e-4,
                               .pre_operational_on_loss = (kind & 8) != 0},
                              1'000'000'000'000);
  can::Cia402Drive drive(device, options);
  run({input, drive, servo, Cia402Wire(node, kRated_Nm), device});
}

}  // namespace hapticd::fuzz
