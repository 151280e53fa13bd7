// Maps and reports of any kind: a map that is taken never leads beyond a report, what is read are the bits that lie there,
// and what is written is read again.
#include <array>
#include <bit>
#include <vector>

#include "drivers/hid/report_map.h"
#include "tests/fuzz/protocol.h"

namespace hapticd::fuzz {
namespace {

using namespace hid;
using Bytes = std::vector<std::uint8_t>;

/// Mostly of a size that fits; any at all now and then.
Place place_of(Input& input) {
  const std::uint8_t kind = input.byte();
  Place place{.offset_bits = input.take<std::uint16_t>(),
              .width_bits = input.byte(),
              .is_signed = (kind & 1) != 0,
              .endian = (kind & 2) != 0 ? Endian::big : Endian::little,
              .is_float = (kind & 4) != 0};
  if ((kind & 0x80) != 0) return place;
  place.offset_bits %= 8 * kMostReportBytes;
  place.width_bits = place.is_float ? 32 : 1 + place.width_bits % 64;
  if ((kind & 6) != 0) {
    place.offset_bits &= ~7U;
    place.width_bits = (place.width_bits + 7) & ~7U;
  }
  return place;
}
double scale_of(Input& input) {
  return input.byte() % 4 == 0 ? input.number() : std::ldexp(1 + input.byte(), -4);
}
std::optional<std::uint8_t> id_of(Input& input) {
  const std::uint8_t id = input.byte();
  return id < 128 ? std::nullopt : std::optional(static_cast<std::uint8_t>(id - 128));
}

InputMap input_map(Input& input) {
  InputMap map{.report_id = id_of(input), .report_bytes = input.byte() % 70U};
  for (int i = input.byte() % 18; i > 0 && !input.empty(); --i) {
    InputField field{.place = place_of(input), .scale = scale_of(input)};
    const std::uint8_t more = input.byte();
    if ((more & 1) != 0) field.offset = input.number();
    if ((more & 2) != 0) field.modulus = std::uint64_t{input.take<std::uint32_t>()} + (more >> 6);
    map.fields.push_back(field);
  }
  if (input.byte() % 2 == 0)
    map.sequence = SequenceField{.place = place_of(input), .modulus = input.byte()};
  return map;
}

OutputMap output_map(Input& input) {
  OutputMap map{.report_id = id_of(input), .report_bytes = input.byte() % 70U};
  for (int i = input.byte() % 18; i > 0 && !input.empty(); --i) {
    OutputField field{.place = place_of(input), .scale = scale_of(input)};
    const std::uint8_t more = input.byte();
    if ((more & 1) != 0) field.offset = input.number();
    if ((more & 2) != 0) field.least = input.number();
    if ((more & 4) != 0) field.most = input.number();
    map.fields.push_back(field);
  }
  for (int i = input.byte() % 4; i > 0; --i)
    map.constants.push_back({.at = input.byte(), .value = input.byte()});
  if (input.byte() % 2 == 0) map.heartbeat = place_of(input);
  if (input.byte() % 4 == 0)
    for (int i = input.byte() % 70; i > 0; --i) map.safe.push_back(input.byte());
  return map;
}

/// Bit by bit.
std::uint64_t bits_at(std::span<const std::uint8_t> report, const Place& place) {
  std::uint64_t bits = 0;
  for (std::uint32_t i = 0; i < place.width_bits; ++i) {
    const std::uint32_t at = place.endian == Endian::little
                                 ? place.offset_bits + i
                                 : place.offset_bits + place.width_bits - 8 - i / 8 * 8 + i % 8;
    must(at / 8 < report.size(), "a place lies within the report");
    bits |= std::uint64_t{(report[at / 8] >> (at % 8)) & 1U} << i;
  }
  return bits;
}
std::int64_t raw_at(std::span<const std::uint8_t> report, const Place& place) {
  const std::uint64_t bits = bits_at(report, place);
  const unsigned above = 64 - place.width_bits;
  const auto raised = static_cast<std::int64_t>(bits << above);
  return place.is_signed && !place.is_float ? raised >> above : static_cast<std::int64_t>(bits);
}
double number_at(std::span<const std::uint8_t> report, const Place& place) {
  const std::uint64_t bits = bits_at(report, place);
  if (place.is_float) return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
  return place.is_signed ? static_cast<double>(raw_at(report, place)) : static_cast<double>(bits);
}

void must_be_words(const Problem& problem, std::size_t fields) {
  must(words(problem.fault).empty() == (problem.fault == Fault::none), "a fault has words");
  must(problem.field == kMostFields || problem.field < fields, "a field that there is");
}

/// Counters go on by less than half their modulus, and by what the numbers say.
void must_follow(const InputMap& map, InputState& state, hid::Reading reading,
                 std::array<std::optional<double>, kMostFields>& before) {
  const hid::Reading raw = reading;
  const auto step = follow(map, state, reading);
  must(map.sequence || step.order == Sequence::Order::next, "without a number there is no order");
  for (std::size_t i = 0; i < map.fields.size(); ++i) {
    const InputField& field = map.fields[i];
    must(std::isfinite(reading.value[i]), "a value is a number");
    if (!field.modulus) {
      must(reading.value[i] == raw.value[i], "what does not count stays");
      continue;
    }
    if (before[i]) {
      const double moved = std::abs(reading.value[i] - *before[i]) / std::abs(field.scale);
      must(moved <= static_cast<double>(*field.modulus) / 2 * (1 + 1e-6) +
                        1e-3 * std::abs(field.offset / field.scale) + 1,
           "it goes the short way");
    }
    before[i] = reading.value[i];
  }
}

bool in_range(const InputMap& map, std::span<const std::uint8_t> report) {
  for (const InputField& field : map.fields) {
    if (!std::isfinite(number_at(report, field.place))) return false;
    const auto modulus = static_cast<std::int64_t>(field.modulus.value_or(0));
    const std::int64_t raw = raw_at(report, field.place);
    if (field.modulus && (raw >= modulus || raw <= -modulus)) return false;
  }
  return !map.sequence || bits_at(report, map.sequence->place) < map.sequence->steps();
}

}  // namespace

void decode(Input& input) {
  const InputMap map = input_map(input);
  const Problem problem = check(map);
  must_be_words(problem, map.fields.size());
  if (problem.fault != Fault::none) return;
  InputState state;
  std::array<std::optional<double>, kMostFields> before{};
  do {
    const std::uint8_t kind = input.byte();
    Bytes report(kind % 8 == 0 ? input.byte() % 70U : map.report_bytes);
    for (std::uint8_t& byte : report) byte = input.byte();
    if (map.report_id && !report.empty() && kind % 8 != 1) report[0] = *map.report_id;
    const hid::Reading reading = decode(map, report);
    const bool mine = !map.report_id || report.empty() || report[0] == *map.report_id;
    must((reading.received == Received::ignore) == !mine, "another id is another report");
    if (!mine) continue;
    const bool whole = report.size() == map.report_bytes;
    must((reading.received == Received::malformed) == !whole, "another length is malformed");
    if (!whole) continue;
    must((reading.received == Received::ok) == in_range(map, report), "in range or not");
    if (reading.received != Received::ok) continue;
    for (std::size_t i = 0; i < map.fields.size(); ++i) {
      const InputField& field = map.fields[i];
      must(reading.raw[i] == raw_at(report, field.place), "the number is the one that lies there");
      const double value = number_at(report, field.place) * field.scale + field.offset;
      must(reading.value[i] == value, "so is its value");
    }
    must_follow(map, state, reading, before);
  } while (!input.empty());
}

namespace {

void must_be_sent(const OutputMap& map, const Encoded& encoded, std::uint64_t heartbeat) {
  must(encoded.size == map.report_bytes, "a report of that length");
  must(!map.report_id || encoded.bytes[0] == *map.report_id, "with its id");
  for (const ConstantByte& constant : map.constants)
    must(encoded.bytes[constant.at] == constant.value, "constants are as they are");
  if (!map.heartbeat) return;
  const unsigned above = 64 - map.heartbeat->width_bits;
  must(bits_at(encoded.report(), *map.heartbeat) << above == heartbeat << above, "the heart beats");
}

void must_carry(const OutputField& field, std::size_t i, double value, const Encoded& encoded) {
  const double sent = number_at(encoded.report(), field.place) * field.scale + field.offset;
  must(sent == carried(field, value), "what is carried is on the wire");
  must(std::isfinite(sent), "and is a number");
  must(encoded.raw[i] == raw_at(encoded.report(), field.place), "so is the raw number");
  if (((encoded.saturated >> i) & 1) != 0) return;
  const double size = std::abs(value) + std::abs(field.offset) + std::abs(sent);
  const double step = field.place.is_float ? std::ldexp(size, -23) + std::abs(field.scale) * 1e-44
                                           : std::abs(field.scale) / 2 + std::ldexp(size, -50);
  must(std::abs(sent - value) <= step * (1 + 1e-9), "the nearest");
}

}  // namespace

void encode(Input& input) {
  const OutputMap map = output_map(input);
  const Problem problem = check(map);
  must_be_words(problem, map.fields.size());
  if (problem.fault != Fault::none) return;
  do {
    const auto heartbeat = input.take<std::uint64_t>();
    std::vector<double> values(map.fields.size());
    bool finite = true;
    for (double& value : values) {
      value = input.number();
      finite = finite && std::isfinite(value);
    }
    const auto encoded = encode(map, values, heartbeat);
    must(encoded.has_value() == finite, "refused where a value is no number");
    if (encoded) {
      must_be_sent(map, *encoded, heartbeat);
      for (std::size_t i = 0; i < values.size(); ++i)
        must_carry(map.fields[i], i, values[i], *encoded);
    }
    values.push_back(0);
    must(!encode(map, values, heartbeat), "one too many is refused");
    const Encoded safe = safe_report(map, heartbeat);
    if (map.safe.empty()) must_be_sent(map, safe, heartbeat);
    must(safe.size == map.report_bytes && safe.saturated == 0, "zero can be sent");
    std::array<std::uint8_t, kMostReportBytes + 1> buffer{};
    const auto out = for_hidapi(safe, map.report_id.has_value(), buffer);
    must(out.size() == safe.size + (map.report_id ? 0U : 1U), "a byte before one without id");
    must(std::equal(safe.report().begin(), safe.report().end(),
                    out.end() - static_cast<std::ptrdiff_t>(safe.size)),
         "and the report");
  } while (!input.empty());
}

}  // namespace hapticd::fuzz
