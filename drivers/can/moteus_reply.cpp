#include <cmath>
#include <limits>

#include "drivers/can/moteus_codec.h"
#include "drivers/can/moteus_formats.h"

namespace hapticd::can::moteus {
namespace {

constexpr std::uint8_t kReply = 0x20, kWriteError = 0x30, kReadError = 0x31, kNop = 0x50;

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
  /// Seven bits a byte, the lowest first; five bytes at most. Wide, so that no register wraps to another.
  std::uint64_t varuint() noexcept {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 35; shift += 7) {
      const std::uint8_t next = byte();
      value |= static_cast<std::uint64_t>(next & 0x7f) << shift;
      if ((next & 0x80) == 0) return value;
    }
    good_ = false;
    return 0;
  }
  double value(std::uint64_t which, Format format) noexcept {
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

void store(Reply& reply, std::uint64_t which, double value) noexcept {
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
    case Register::maximum_torque:
      reply.maximum_torque = value;
      break;
    case Register::watchdog_timeout:
      reply.watchdog = value;
      break;
    case Register::serial_number:
      if (std::abs(value) <= 2147483647) reply.serial_number = static_cast<std::int32_t>(value);
      break;
    default:
      break;
  }
}

/// The values of one subframe; false: the payload ends within it.
bool take_values(Reader& reader, std::uint8_t head, Reply& reply) noexcept {
  const auto format = static_cast<Format>((head >> 2) & 3);
  const std::uint64_t count = (head & 3) != 0 ? head & 3u : reader.varuint();
  const std::uint64_t first = reader.varuint();
  for (std::uint64_t i = 0; i < count && reader.good(); ++i) {
    const double value = reader.value(first + i, format);
    if (reader.good()) store(reply, first + i, value);
  }
  return reader.good();
}

}  // namespace

Decoded decode(std::span<const std::uint8_t> payload) noexcept {
  Decoded decoded;
  Reader reader(payload);
  while (!reader.empty()) {
    const std::uint8_t head = reader.byte();
    if (head == kNop) continue;
    if (head == kWriteError || head == kReadError) {
      const RegisterError error{head == kWriteError, static_cast<std::uint32_t>(reader.varuint()),
                                static_cast<std::uint32_t>(reader.varuint())};
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
