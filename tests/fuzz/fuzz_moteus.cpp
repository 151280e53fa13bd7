// moteus' subframes: what is decoded is in the bytes, what is encoded can be read again, and the
// servo's state machine never arms or pulls when it must not.
#include <map>
#include <vector>

#include "drivers/can/moteus_codec.h"
#include "drivers/can/moteus_drive.h"
#include "sim/can/moteus_drive.h"
#include "sim/can/moteus_scale.h"
#include "tests/fuzz/protocol.h"
#include "tests/fuzz/session.h"

namespace hapticd::fuzz {
namespace {

namespace moteus = can::moteus;
using moteus::Status;

/// A payload read again in one pass, with numbers too wide to wrap.
struct Value {
  std::uint8_t kind = 0;  ///< highest four bits of the subframe's head
  std::uint64_t which = 0;
  std::uint8_t format = 0;
  std::span<const std::uint8_t> bytes{};
};
struct Scan {
  std::vector<Value> values;
  std::vector<std::uint8_t> others;  ///< heads that are none of a register
  bool strange = false;              ///< subframes that no reply has
  bool whole = true;
};
class Scanner {
 public:
  explicit Scanner(std::span<const std::uint8_t> payload) : rest_(payload) {
    scan_.values.reserve(32);
  }

  Scan scan() {
    while (scan_.whole && !rest_.empty()) {
      const std::uint8_t head = take(1)[0];
      if (head == 0x50) continue;
      scan_.strange = scan_.strange || head < 0x20 || head > 0x31;
      if (head < 0x30) {
        registers(head);
      } else {
        scan_.others.push_back(head);
        if (head > 0x31) return scan_;
        number();
        number();
      }
    }
    return scan_;
  }

 private:
  std::span<const std::uint8_t> take(std::size_t count) {
    scan_.whole = scan_.whole && count <= rest_.size();
    if (!scan_.whole) return {};
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    for (int i = 0; i < 5; ++i) {
      const auto byte = take(1);
      if (!scan_.whole) return 0;
      value |= std::uint64_t{byte[0] & 0x7fu} << 7 * i;
      if (byte[0] < 0x80) return value;
    }
    scan_.whole = false;
    return 0;
  }
  void registers(std::uint8_t head) {
    constexpr std::size_t kBytes[] = {1, 2, 4, 4};
    const auto format = static_cast<std::uint8_t>((head >> 2) & 3);
    const std::uint64_t count = (head & 3) != 0 ? head & 3u : number();
    const std::uint64_t first = number();
    const bool reads = head >> 4 == 1;
    for (std::uint64_t i = 0; i < count && scan_.whole && i < 128; ++i) {
      const auto bytes = take(reads ? 0 : kBytes[format]);
      if (!scan_.whole) return;
      scan_.values.push_back({static_cast<std::uint8_t>(head >> 4), first + i, format, bytes});
    }
  }

  std::span<const std::uint8_t> rest_;
  Scan scan_;
};
Scan scan_of(const can::Frame& frame) {
  return Scanner(frame.payload()).scan();
}

double number_of(const Value& value) {
  return sim::can::moteus_decode(static_cast<std::uint32_t>(value.which),
                                 static_cast<sim::can::MoteusType>(value.format), value.bytes);
}

class MoteusWire final : public Wire {
 public:
  MoteusWire(const moteus::Address& address, double most_Nm)
      : address_(address), most_Nm_(most_Nm) {}

  /// Replies; every eighth a command of another host.
  void own(can::Frame& frame, std::uint32_t number) const override {
    const bool command = number % 8 == 7;
    frame.id = std::uint32_t{address_.prefix} << 16 |
               (command ? 0x8000u | (number & 0x7f00u) | address_.servo
                        : std::uint32_t{address_.servo} << 8 | address_.source);
    frame.extended = frame.id >= 0x800;
    frame.fd = frame.fast = true;
  }
  /// Each command is whole: it holds nothing by itself, and it ends.
  std::optional<double> torque_of(const can::Frame& frame) const override {
    const Scan scan = scan_of(frame);
    must(scan.whole && scan.others.empty(), "what goes out can be read");
    std::map<std::uint64_t, double> written;
    for (const Value& value : scan.values)
      if (value.kind == 0) written[value.which] = number_of(value);
    if (!written.contains(0x022)) return std::nullopt;
    must(scan.values[0].kind == 0 && scan.values[0].which == 0, "a command begins with its mode");
    must(written.at(0) == 10 && std::isnan(written.at(0x020)), "in position mode without one");
    for (const std::uint64_t none : {0x021u, 0x023u, 0x024u, 0x02bu})
      must(written.at(none) == 0, "no velocity, gains, integrator");
    must(std::abs(written.at(0x025) - most_Nm_) <= 1e-6 * most_Nm_, "clipped at what it may have");
    must(written.at(0x027) > 0, "a watchdog");
    return written.at(0x022);
  }
  double tolerance_Nm(double wanted) const override {
    return std::ldexp(std::abs(wanted), -24) + std::numeric_limits<float>::denorm_min();
  }

 private:
  moteus::Address address_;
  double most_Nm_;
};

moteus::Address address_from(Input& input) {
  constexpr std::uint16_t kPrefixes[] = {0, 0, 0, 0x1fff};
  const std::uint8_t kind = input.byte();
  return {.servo = static_cast<std::uint8_t>(1 + input.byte() % 126),
          .source = static_cast<std::uint8_t>((kind & 0x80) != 0 ? kind & 0x7f : 0),
          .prefix = kPrefixes[kind & 3]};
}

/// The last value of a register that a payload has, as the drive meant it.
void check_field(const Scan& scan, std::uint64_t which, bool present, double found) {
  const Value* last = nullptr;
  for (const Value& value : scan.values)
    if (value.kind == 2 && value.which == which) last = &value;
  must(!present || last != nullptr, "a field that the payload has");
  if (last == nullptr) return;
  const double expected = number_of(*last);
  const bool none = std::isnan(expected) || last->bytes.back() == 0x80;  // may be the wire's "none"
  if (present)
    must(found == expected || (std::isnan(found) && none), "the value that the payload has");
  else
    must(none || std::abs(expected) >= 1e9, "what the payload has is there");
}

void check_reply(const moteus::Decoded& decoded, const Scan& scan) {
  const moteus::Reply& r = decoded.reply;
  const auto check = [&](std::uint64_t which, const auto& field) {
    check_field(scan, which, field.has_value(), field ? static_cast<double>(*field) : 0);
  };
  check(0x000, r.mode);
  check(0x001, r.position);
  check(0x002, r.velocity);
  check(0x003, r.torque);
  check(0x00d, r.voltage);
  check(0x00e, r.temperature);
  check(0x00f, r.fault);
  check(0x070, r.milliseconds);
  check(0x025, r.maximum_torque);
  check(0x027, r.watchdog);
  if (r.register_map_version) check(0x102, r.register_map_version);
  if (r.serial_number) check(0x120, r.serial_number);
}

}  // namespace

void decode(Input& input) {
  const moteus::Address address = address_from(input);
  const MoteusWire wire(address, 1);
  const can::Frame frame =
      frame_of(input, [&](auto& own, std::uint32_t number) { wire.own(own, number); });
  if (moteus::is_reply(frame, address))
    must(!frame.error && !frame.remote && (frame.id & 0x8000) == 0, "a reply");
  // Nothing stands behind its last byte.
  const std::vector<std::uint8_t> payload(frame.payload().begin(), frame.payload().end());
  const moteus::Decoded decoded = moteus::decode(payload);
  must(decoded.status <= Status::error_subframe, "a verdict that there is");
  must(decoded.reply.tag() >= 0 && decoded.reply.tag() <= 3, "one of four tags");
  const Scan scan = scan_of(frame);
  if (decoded.status == Status::ok) {
    must(scan.whole && scan.others.empty() && !decoded.error, "whole, and nothing but registers");
    for (const Value& value : scan.values) must(value.kind == 2, "nothing but replies");
    check_reply(decoded, scan);
  }
  if (decoded.status == Status::error_subframe) {
    must(scan.whole && decoded.error.has_value() && !scan.others.empty(), "an error is in it");
    check_reply(decoded, scan);
  }
  if (decoded.status == Status::unknown_subframe) must(scan.strange, "something else is in it");
  if (decoded.status == Status::truncated) must(!scan.whole, "it is cut off");
}

namespace {

void check_torque_command(Input& input, const moteus::Address& address) {
  const moteus::TorqueCommand command{.torque_Nm = input.number(),
                                      .maximum_torque_Nm = input.number(),
                                      .watchdog_s = input.number(),
                                      .ignore_position_bounds = (input.byte() & 1) != 0};
  const std::uint8_t kind = input.byte();
  std::optional<moteus::Query> query;
  if ((kind & 1) != 0) query = {.settings = (kind & 2) != 0, .tag = (kind >> 2) & 3};
  const auto frame = moteus::torque_command(address, command, query);
  must(frame.has_value() == (is_single(command.torque_Nm) && is_single(command.maximum_torque_Nm) &&
                             is_single(command.watchdog_s)),
       "refused where a value is no number");
  if (!frame) return;
  must_be_legal(*frame);
  const bool arms = query && query->settings;
  must(frame->size <= (arms ? 64 : 48) && frame->fd && frame->fast, "as short as it is to be");
  const Scan scan = scan_of(*frame);
  must(scan.whole && scan.others.empty(), "what goes out can be read");
  int asked = 0;
  for (const Value& value : scan.values) {
    if (value.kind == 1) ++asked;
    if (value.kind != 0) continue;
    if (value.which == 0x022) must(is_nearest(number_of(value), command.torque_Nm), "torque");
    if (value.which == 0x025) must(is_nearest(number_of(value), command.maximum_torque_Nm), "most");
    if (value.which == 0x027) must(is_nearest(number_of(value), command.watchdog_s), "watchdog");
  }
  must((asked > 0) == query.has_value() && ((frame->id & 0x8000) != 0) == (asked > 0),
       "an answer is asked for where there is a question");
}

/// Any writes and reads: refused, or read back within a step.
void check_writer(Input& input, const moteus::Address& address) {
  constexpr moteus::Register kRegisters[] = {
      moteus::Register::position, moteus::Register::torque,
      moteus::Register::kp_scale, moteus::Register::command_velocity,
      moteus::Register::voltage,  moteus::Register::temperature,
      moteus::Register::mode,     moteus::Register::watchdog_timeout};
  struct Written {
    std::uint16_t which;
    std::uint8_t format;
    bool reads;
    double value;
  };
  std::vector<Written> all;
  moteus::Writer writer(moteus::to_servo(address, true));
  bool numbers = true;
  for (int i = input.byte() % 24; i > 0; --i) {
    const std::uint8_t kind = input.byte();
    const auto which = static_cast<std::uint16_t>(kRegisters[kind & 7]);
    const auto format = static_cast<std::uint8_t>((kind >> 3) & 3);
    const bool reads = (kind & 0x20) != 0;
    const double value = reads ? 0 : input.number();
    if (reads)
      writer.read(static_cast<moteus::Register>(which), static_cast<moteus::Format>(format));
    else
      writer.write(static_cast<moteus::Register>(which), static_cast<moteus::Format>(format),
                   value);
    numbers =
        numbers && !std::isinf(value) && (format != 3 || std::isnan(value) || is_single(value));
    all.push_back({which, format, reads, value});
  }
  const auto frame = writer.finish();
  must(!frame || numbers, "refused where a value is infinite on the wire");
  must(frame || !numbers || writer.size() == 64, "refused only where it must be");
  if (!frame) return;
  must_be_legal(*frame);
  const Scan scan = scan_of(*frame);
  must(scan.whole && scan.others.empty() && scan.values.size() == all.size(), "it can be read");
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Value& value = scan.values[i];
    must(value.which == all[i].which && value.format == all[i].format &&
             value.kind == (all[i].reads ? 1 : 0),
         "the registers in their order");
    if (all[i].reads) continue;
    const double found = number_of(value), wanted = all[i].value;
    if (std::isnan(wanted)) {
      must(std::isnan(found) || all[i].which == 0, "none stays none");
    } else if (all[i].format == 3) {
      must(is_nearest(found, wanted), "the nearest single");
    } else {
      const auto type = static_cast<sim::can::MoteusType>(all[i].format);
      const double step = sim::can::moteus_step(all[i].which, type);
      const double most = step * sim::can::moteus_largest(type);
      must(std::abs(found - std::clamp(wanted, -most, most)) <= step * (1 + 1e-9), "within a step");
    }
  }
}

}  // namespace

void encode(Input& input) {
  const moteus::Address address = address_from(input);
  check_torque_command(input, address);
  check_writer(input, address);
  const auto code = input.take<int>();
  must(moteus::is_limit(code) == (code >= 96 && code <= 103), "a limit");
  must(moteus::fault_word(code).size() < 64, "a word of a code");
}

void session(Input& input) {
  const std::uint8_t kind = input.byte();
  const moteus::Address address = address_from(input);
  const can::DeviceOptions device{
      .timing = (kind & 1) != 0 ? drivers::Timing::in_phase : drivers::Timing::reply_to_command,
      .source = address.source,
      .prefix = address.prefix,
      .ignore_position_bounds = (kind & 4) != 0};
  const can::DriveOptions options{.axis = "fuzz.x",
                                  .interface = "can0",
                                  .node = address.servo,
                                  .counts_per_unit = (kind & 2) != 0 ? -1000.0 : 1000.0,
                                  .counts_per_turn = 16384};
  sim::can::MoteusDrive servo({.servo = address.servo,
                               .prefix = address.prefix,
                               .register_map_version = (kind & 0x70) == 0x70 ? 4 : 5},
                              1'000'000'000'000);
  can::MoteusDrive drive(device, options);
  run({input, drive, servo, MoteusWire(address, drive.max_torque_Nm()), device});
}

}  // namespace hapticd::fuzz
