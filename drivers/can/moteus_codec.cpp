#include "drivers/can/moteus_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hapticd::can::moteus {
namespace {

constexpr std::uint8_t kWrite = 0x00, kRead = 0x10, kReply = 0x20, kWriteError = 0x30,
                       kReadError = 0x31, kNop = 0x50;
constexpr std::uint32_t kAsksForReply = 0x8000;

std::uint16_t number(Register which) noexcept {
  return static_cast<std::uint16_t>(which);
}

std::size_t size_of(Format format) noexcept {
  return format == Format::int8 ? 1 : format == Format::int16 ? 2 : 4;
}

/// One step of each integer format.
struct Steps {
  double int8, int16, int32;
};
Steps steps_of(std::uint16_t which) noexcept {
  switch (static_cast<Register>(which)) {
    case Register::position:
    case Register::command_position:
    case Register::within_lower:
    case Register::within_upper:
      return {0.01, 1e-4, 1e-5};
    case Register::velocity:
    case Register::command_velocity:
      return {0.1, 2.5e-4, 1e-5};
    case Register::torque:
    case Register::feedforward_torque:
    case Register::maximum_torque:
    case Register::within_feedforward_torque:
    case Register::within_maximum_torque:
      return {0.5, 0.01, 0.001};
    case Register::kp_scale:
    case Register::kd_scale:
    case Register::ilimit_scale:
      return {1.0 / 127, 1.0 / 32767, 1.0 / 2147483647};
    case Register::voltage:
      return {0.5, 0.1, 0.001};
    case Register::temperature:
      return {1, 0.1, 0.001};
    case Register::watchdog_timeout:
    case Register::within_watchdog_timeout:
      return {0.01, 0.001, 1e-6};
    default:
      return {1, 1, 1};
  }
}
double step_of(std::uint16_t which, Format format) noexcept {
  const Steps steps = steps_of(which);
  return format == Format::int8 ? steps.int8 : format == Format::int16 ? steps.int16 : steps.int32;
}

/// Towards zero, saturated; NaN is the most negative number.
template <class Integer>
Integer in_steps(double value, double step) noexcept {
  using Limits = std::numeric_limits<Integer>;
  if (std::isnan(value)) return Limits::min();
  const double most = Limits::max();
  return static_cast<Integer>(std::clamp(std::trunc(value / step), -most, most));
}
template <class Integer>
double out_of_steps(std::span<const std::uint8_t> bytes, double step) noexcept {
  const auto raw = get<Integer>(bytes, 0);
  return raw == std::numeric_limits<Integer>::min() ? std::nan("") : raw * step;
}

/// Bytes of a payload, in order; `good` until something was asked for that is not there.
class Reader {
 public:
  explicit Reader(std::span<const std::uint8_t> bytes) noexcept : rest_(bytes) {}
  bool empty() const noexcept { return rest_.empty(); }
  bool good() const noexcept { return good_; }
  std::span<const std::uint8_t> take(std::size_t count) noexcept {
    if (count > rest_.size()) {
      good_ = false;
      rest_ = {};
      return {};
    }
    const auto taken = rest_.first(count);
    rest_ = rest_.subspan(count);
    return taken;
  }
  std::uint8_t byte() noexcept {
    const auto one = take(1);
    return good_ ? one[0] : std::uint8_t{0};
  }
  /// Seven bits a byte, the lowest first; five bytes at most.
  std::uint32_t varuint() noexcept {
    std::uint32_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const std::uint8_t next = byte();
      value |= static_cast<std::uint32_t>(next & 0x7f) << shift;
      if ((next & 0x80) == 0) return value;
    }
    good_ = false;
    return 0;
  }
  double value(std::uint32_t which, Format format) noexcept {
    const auto bytes = take(size_of(format));
    if (!good_) return 0;
    const double step = step_of(static_cast<std::uint16_t>(which), format);
    switch (format) {
      case Format::int8:
        return out_of_steps<std::int8_t>(bytes, step);
      case Format::int16:
        return out_of_steps<std::int16_t>(bytes, step);
      case Format::int32:
        return out_of_steps<std::int32_t>(bytes, step);
      case Format::real:
        break;
    }
    return get<float>(bytes, 0);
  }

 private:
  std::span<const std::uint8_t> rest_;
  bool good_ = true;
};

void store(Reply& reply, std::uint32_t which, double value) noexcept {
  if (which > 0xffff) return;
  switch (static_cast<Register>(which)) {
    case Register::mode:
      reply.mode = value;
      break;
    case Register::position:
      reply.position = value;
      break;
    case Register::velocity:
      reply.velocity = value;
      break;
    case Register::torque:
      reply.torque = value;
      break;
    case Register::voltage:
      reply.voltage = value;
      break;
    case Register::temperature:
      reply.temperature = value;
      break;
    case Register::fault:
      reply.fault = value;
      break;
    case Register::millisecond_counter:
      reply.milliseconds = value;
      break;
    case Register::register_map_version:
      if (std::abs(value) < 1e9) reply.register_map_version = static_cast<std::int32_t>(value);
      break;
    default:
      break;
  }
}

/// The values of one subframe; false: the payload ends within it.
bool take_values(Reader& reader, std::uint8_t head, Reply& reply) noexcept {
  const auto format = static_cast<Format>((head >> 2) & 3);
  const std::uint32_t count = (head & 3) != 0 ? head & 3 : reader.varuint();
  const std::uint32_t first = reader.varuint();
  for (std::uint32_t i = 0; i < count && reader.good(); ++i) {
    const double value = reader.value(first + i, format);
    if (reader.good()) store(reply, first + i, value);
  }
  return reader.good();
}

}  // namespace

Frame to_servo(const Address& address, bool reply) noexcept {
  Frame frame;
  frame.id = (std::uint32_t{address.prefix} << 16) | (reply ? kAsksForReply : 0) |
             (std::uint32_t{address.source} << 8) | address.servo;
  frame.extended = frame.id >= 0x800;
  frame.fd = frame.fast = true;
  return frame;
}

bool is_reply(const Frame& frame, const Address& address) noexcept {
  const std::uint32_t id =
      (std::uint32_t{address.prefix} << 16) | (std::uint32_t{address.servo} << 8) | address.source;
  return !frame.error && !frame.remote && frame.id == id && frame.extended == (id >= 0x800);
}

bool Writer::extends(bool reads, std::uint16_t which, Format format) const noexcept {
  return run_.count > 0 && run_.reads == reads && run_.format == format &&
         which == run_.first + run_.count && run_.bytes + size_of(format) <= run_.values.size();
}

void Writer::begin(bool reads, std::uint16_t which, Format format) noexcept {
  flush();
  run_ = {.reads = reads, .format = format, .first = which};
}

Writer& Writer::write(Register which, Format format, double value) noexcept {
  if (std::isinf(value)) good_ = false;
  if (!extends(false, number(which), format)) begin(false, number(which), format);
  const double step = step_of(number(which), format);
  const auto keep = [&](auto raw) {
    std::memcpy(run_.values.data() + run_.bytes, &raw, sizeof raw);
    run_.bytes += sizeof raw;
  };
  switch (format) {
    case Format::int8:
      keep(in_steps<std::int8_t>(value, step));
      break;
    case Format::int16:
      keep(in_steps<std::int16_t>(value, step));
      break;
    case Format::int32:
      keep(in_steps<std::int32_t>(value, step));
      break;
    case Format::real:
      keep(static_cast<float>(value));
      break;
  }
  ++run_.count;
  return *this;
}

Writer& Writer::read(Register which, Format format) noexcept {
  if (!extends(true, number(which), format)) begin(true, number(which), format);
  ++run_.count;
  return *this;
}

void Writer::flush() noexcept {
  if (run_.count == 0) return;
  const auto head = static_cast<std::uint8_t>((run_.reads ? kRead : kWrite) |
                                              (static_cast<int>(run_.format) << 2));
  append(run_.count <= 3 ? static_cast<std::uint8_t>(head | run_.count) : head);
  if (run_.count > 3) append_varuint(run_.count);
  append_varuint(run_.first);
  for (std::size_t i = 0; i < run_.bytes; ++i) append(run_.values[i]);
  run_ = {};
}

void Writer::append(std::uint8_t byte) noexcept {
  if (size_ == frame_.data.size()) {
    good_ = false;
    return;
  }
  frame_.data[size_++] = byte;
}

void Writer::append_varuint(std::uint32_t value) noexcept {
  for (; value >= 0x80; value >>= 7) append(static_cast<std::uint8_t>(value | 0x80));
  append(static_cast<std::uint8_t>(value));
}

std::optional<Frame> Writer::finish() noexcept {
  flush();
  if (!good_) return std::nullopt;
  frame_.size = fd_length(size_);
  std::fill(frame_.data.begin() + static_cast<std::ptrdiff_t>(size_),
            frame_.data.begin() + frame_.size, kNop);
  return frame_;
}

namespace {

void ask(Writer& writer) noexcept {
  writer.read(Register::mode, Format::int8)
      .read(Register::position, Format::real)
      .read(Register::velocity, Format::real)
      .read(Register::torque, Format::real)
      .read(Register::voltage, Format::int8)
      .read(Register::temperature, Format::int8)
      .read(Register::fault, Format::int8);
}

}  // namespace

std::optional<Frame> torque_command(const Address& address, const TorqueCommand& command) noexcept {
  if (!std::isfinite(command.torque_Nm) || !std::isfinite(command.maximum_torque_Nm) ||
      !std::isfinite(command.watchdog_s) ||
      std::abs(command.torque_Nm) > std::numeric_limits<float>::max())
    return std::nullopt;
  Writer writer(to_servo(address, true));
  writer.write(Register::mode, Format::int8, static_cast<double>(Mode::position))
      .write(Register::command_position, Format::real, std::nan(""))
      .write(Register::command_velocity, Format::real, 0)
      .write(Register::feedforward_torque, Format::real, command.torque_Nm)
      .write(Register::kp_scale, Format::real, 0)
      .write(Register::kd_scale, Format::real, 0)
      .write(Register::maximum_torque, Format::real, command.maximum_torque_Nm)
      .write(Register::watchdog_timeout, Format::real, command.watchdog_s)
      .write(Register::ilimit_scale, Format::real, 0);
  ask(writer);
  return writer.finish();
}

Frame stop(const Address& address) noexcept {
  Writer writer(to_servo(address, true));
  writer.write(Register::mode, Format::int8, static_cast<double>(Mode::stopped));
  ask(writer);
  return *writer.finish();
}

Frame query(const Address& address) noexcept {
  Writer writer(to_servo(address, true));
  ask(writer);
  return *writer.finish();
}

Decoded decode(std::span<const std::uint8_t> payload) noexcept {
  Decoded decoded;
  Reader reader(payload);
  while (!reader.empty()) {
    const std::uint8_t head = reader.byte();
    if (head == kNop) continue;
    if (head == kWriteError || head == kReadError) {
      const RegisterError error{head == kWriteError, reader.varuint(), reader.varuint()};
      if (!reader.good()) break;
      decoded.status = Status::error_subframe;
      if (!decoded.error) decoded.error = error;
      continue;
    }
    if ((head & 0xf0) != kReply) {
      decoded.status = Status::unknown_subframe;
      return decoded;
    }
    if (!take_values(reader, head, decoded.reply)) break;
  }
  if (!reader.good()) decoded.status = Status::truncated;
  return decoded;
}

std::string_view fault_word(int code) noexcept {
  switch (code) {
    case 32:
      return "calibration fault";
    case 33:
      return "motor driver fault";
    case 34:
      return "over-voltage";
    case 35:
      return "encoder fault";
    case 36:
      return "motor not configured";
    case 37:
      return "PWM cycle overrun";
    case 38:
      return "over-temperature";
    case 39:
      return "started outside of the position limits";
    case 40:
      return "under-voltage";
    case 41:
      return "configuration changed";
    case 42:
      return "commutation angle invalid";
    case 43:
      return "position invalid";
    case 44:
      return "driver enable fault";
    case 45:
      return "stop position with velocity limits";
    case 46:
      return "timing violation";
    case 47:
      return "back EMF feed-forward without acceleration limit";
    case 48:
      return "invalid limits";
    case 49:
      return "position error";
    case 50:
      return "velocity error";
    case 102:
      return "limited by the commanded maximum torque";
    default:
      return is_limit(code) ? "limited by a setting of the servo" : std::string_view();
  }
}

bool is_limit(int code) noexcept {
  return code >= 96 && code <= 103;
}

}  // namespace hapticd::can::moteus
