#include "drivers/hid/report_map.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace hapticd::hid {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::uint64_t mask_of(std::uint32_t width_bits) noexcept {
  return width_bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << width_bits) - 1;
}

/// The bytes that a little endian number touches, at most nine.
struct Window {
  std::size_t first = 0, bytes = 0;
  unsigned shift = 0;
};
constexpr Window window_of(const Place& place) noexcept {
  const unsigned shift = place.offset_bits % 8;
  return {place.offset_bits / 8, (shift + place.width_bits + 7) / 8, shift};
}

constexpr std::int64_t extended(std::uint64_t bits, const Place& place) noexcept {
  const bool negative =
      place.is_signed && !place.is_float && ((bits >> (place.width_bits - 1)) & 1) != 0;
  return static_cast<std::int64_t>(negative ? bits | ~mask_of(place.width_bits) : bits);
}

double number_of(std::int64_t raw, const Place& place) noexcept {
  if (place.is_float) return double{std::bit_cast<float>(static_cast<std::uint32_t>(raw))};
  return place.is_signed ? static_cast<double>(raw)
                         : static_cast<double>(static_cast<std::uint64_t>(raw));
}

struct Converted {
  std::uint64_t bits = 0;
  bool saturated = false;
};

/// `counts`: whole. Powers of two are exact doubles; the greatest number of a wide field is not.
Converted clipped_to_width(double counts, const Place& place) noexcept {
  const std::uint64_t mask = mask_of(place.width_bits);
  if (place.is_signed) {
    const double bound = std::ldexp(1.0, static_cast<int>(place.width_bits) - 1);
    if (counts >= bound) return {mask >> 1, true};
    if (counts < -bound) return {(mask >> 1) + 1, true};
    return {static_cast<std::uint64_t>(static_cast<std::int64_t>(counts)) & mask, false};
  }
  if (counts < 0) return {0, true};
  if (counts >= std::ldexp(1.0, static_cast<int>(place.width_bits))) return {mask, true};
  return {static_cast<std::uint64_t>(counts), false};
}

/// Never beyond the largest single; and zero has no sign.
Converted nearest_single(double number) noexcept {
  constexpr double kLargest = std::numeric_limits<float>::max();
  const double clipped = std::clamp(number, -kLargest, kLargest);
  return {std::bit_cast<std::uint32_t>(static_cast<float>(clipped) + 0.0F), clipped != number};
}

/// Precondition: `value` is finite; the map is good, so that nothing here is NaN.
Converted convert(const OutputField& field, double value) noexcept {
  const double clipped = std::clamp(value, field.least, field.most);
  const double number = (clipped - field.offset) / field.scale;
  Converted converted = field.place.is_float ? nearest_single(number)
                                             : clipped_to_width(std::round(number), field.place);
  converted.saturated |= clipped != value;
  return converted;
}

/// Is it a number that a counter of this modulus can have?
bool within(std::int64_t raw, std::uint64_t modulus) noexcept {
  const auto bound = static_cast<std::int64_t>(modulus);
  return raw > -bound && raw < bound;
}

std::uint64_t steps_on(std::int64_t to, std::int64_t from, std::uint64_t modulus) noexcept {
  const auto m = static_cast<std::int64_t>(modulus);
  const std::int64_t rest = (to - from) % m;
  return static_cast<std::uint64_t>(rest < 0 ? rest + m : rest);
}

Encoded empty_report(const OutputMap& map) noexcept {
  Encoded encoded;
  encoded.size = map.report_bytes;
  if (map.report_id) encoded.bytes[0] = *map.report_id;
  for (const ConstantByte& constant : map.constants) encoded.bytes[constant.at] = constant.value;
  return encoded;
}

void put_heartbeat(const OutputMap& map, std::uint64_t heartbeat, Encoded& encoded) noexcept {
  if (map.heartbeat) write_bits({encoded.bytes.data(), encoded.size}, *map.heartbeat, heartbeat);
}

void put_value(const OutputMap& map, std::size_t i, double value, Encoded& encoded) noexcept {
  const OutputField& field = map.fields[i];
  const Converted converted = convert(field, value);
  write_bits({encoded.bytes.data(), encoded.size}, field.place, converted.bits);
  encoded.raw[i] = extended(converted.bits, field.place);
  if (converted.saturated) encoded.saturated |= std::uint32_t{1} << i;
}

}  // namespace

std::uint64_t read_bits(std::span<const std::uint8_t> report, const Place& place) noexcept {
  const Window window = window_of(place);
  const std::uint8_t* first = report.data() + window.first;
  std::uint64_t bits = 0;
  if (place.endian == Endian::big) {
    for (std::size_t i = 0; i < window.bytes; ++i) bits = (bits << 8) | first[i];
    return bits;
  }
  std::memcpy(&bits, first, std::min<std::size_t>(window.bytes, 8));
  bits >>= window.shift;
  if (window.bytes > 8) bits |= std::uint64_t{first[8]} << (64 - window.shift);
  return bits & mask_of(place.width_bits);
}

void write_bits(std::span<std::uint8_t> report, const Place& place, std::uint64_t bits) noexcept {
  const Window window = window_of(place);
  std::uint8_t* first = report.data() + window.first;
  if (place.endian == Endian::big) {
    for (std::size_t i = window.bytes; i-- > 0; bits >>= 8)
      first[i] = static_cast<std::uint8_t>(bits);
    return;
  }
  const std::uint64_t mask = mask_of(place.width_bits);
  bits &= mask;
  const std::size_t low_bytes = std::min<std::size_t>(window.bytes, 8);
  std::uint64_t low = 0;
  std::memcpy(&low, first, low_bytes);
  low = (low & ~(mask << window.shift)) | (bits << window.shift);
  std::memcpy(first, &low, low_bytes);
  if (window.bytes <= 8) return;
  const unsigned done = 64 - window.shift;
  first[8] = static_cast<std::uint8_t>((first[8] & ~(mask >> done)) | (bits >> done));
}

std::int64_t read_raw(std::span<const std::uint8_t> report, const Place& place) noexcept {
  return extended(read_bits(report, place), place);
}

Reading decode(const InputMap& map, std::span<const std::uint8_t> report) noexcept {
  Reading reading;
  if (map.report_id && !report.empty() && report[0] != *map.report_id) return reading;
  reading.received = Received::malformed;
  if (report.size() != map.report_bytes) return reading;
  reading.received = Received::ok;
  for (std::size_t i = 0; i < map.fields.size(); ++i) {
    const InputField& field = map.fields[i];
    reading.raw[i] = read_raw(report, field.place);
    const double number = number_of(reading.raw[i], field.place);
    reading.value[i] = number * field.scale + field.offset;
    if (!std::isfinite(number)) reading.received = Received::out_of_range;
    if (field.modulus && !within(reading.raw[i], *field.modulus))
      reading.received = Received::out_of_range;
  }
  if (map.sequence) {
    reading.sequence = read_bits(report, map.sequence->place);
    if (reading.sequence >= map.sequence->steps()) reading.received = Received::out_of_range;
  }
  return reading;
}

std::int64_t Unwrap::step(std::int64_t raw, std::uint64_t modulus) noexcept {
  if (!started_) {
    started_ = true;
    previous_ = count_ = raw;
    return count_;
  }
  const std::uint64_t on = steps_on(raw, previous_, modulus);
  const bool up = on < modulus - on;
  count_ += up ? static_cast<std::int64_t>(on) : -static_cast<std::int64_t>(modulus - on);
  previous_ = raw;
  return count_;
}

Sequence::Step Sequence::step(std::uint64_t number, std::uint64_t modulus) noexcept {
  const bool first = !started_;
  const std::uint64_t on = first ? 0
                                 : steps_on(static_cast<std::int64_t>(number),
                                            static_cast<std::int64_t>(last_), modulus);
  started_ = true;
  last_ = number;
  if (first) return {Order::first, 0};
  if (on == 0) return {Order::repeated, 0};
  if (on == 1) return {Order::next, 0};
  return on <= modulus / 2 ? Step{Order::lost, on - 1} : Step{Order::back, 0};
}

Sequence::Step follow(const InputMap& map, InputState& state, Reading& reading) noexcept {
  for (std::size_t i = 0; i < map.fields.size(); ++i) {
    const InputField& field = map.fields[i];
    if (!field.modulus) continue;
    const std::int64_t count = state.counters[i].step(reading.raw[i], *field.modulus);
    reading.value[i] = static_cast<double>(count) * field.scale + field.offset;
  }
  if (!map.sequence) return {Sequence::Order::next, 0};
  return state.sequence.step(reading.sequence, map.sequence->steps());
}

std::optional<Encoded> encode(const OutputMap& map, std::span<const double> values,
                              std::uint64_t heartbeat) noexcept {
  if (values.size() != map.fields.size()) return std::nullopt;
  Encoded encoded = empty_report(map);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) return std::nullopt;
    put_value(map, i, values[i], encoded);
  }
  put_heartbeat(map, heartbeat, encoded);
  return encoded;
}

double carried(const OutputField& field, double value) noexcept {
  const std::int64_t raw = extended(convert(field, value).bits, field.place);
  return number_of(raw, field.place) * field.scale + field.offset;
}

Encoded safe_report(const OutputMap& map, std::uint64_t heartbeat) noexcept {
  Encoded encoded = empty_report(map);
  if (map.safe.empty()) {
    for (std::size_t i = 0; i < map.fields.size(); ++i) put_value(map, i, 0, encoded);
  } else {
    std::copy(map.safe.begin(), map.safe.end(), encoded.bytes.begin());
    for (std::size_t i = 0; i < map.fields.size(); ++i)
      encoded.raw[i] = read_raw(encoded.report(), map.fields[i].place);
  }
  put_heartbeat(map, heartbeat, encoded);
  return encoded;
}

std::span<const std::uint8_t> for_hidapi(
    const Encoded& encoded, bool numbered,
    std::array<std::uint8_t, kMostReportBytes + 1>& buffer) noexcept {
  const std::size_t before = numbered ? 0 : 1;
  buffer[0] = 0;
  std::copy_n(encoded.bytes.begin(), encoded.size,
              buffer.begin() + static_cast<std::ptrdiff_t>(before));
  return {buffer.data(), before + encoded.size};
}

}  // namespace hapticd::hid
