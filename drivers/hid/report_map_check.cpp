// What may be wrong with a map.
#include <bit>
#include <bitset>
#include <cmath>

#include "drivers/hid/report_map.h"

namespace hapticd::hid {
namespace {

constexpr std::uint64_t kMostModulus = std::uint64_t{1} << 32;

/// Which bits of a report are taken.
class Taken {
 public:
  explicit Taken(std::size_t report_bytes) noexcept : bits_(report_bytes * 8) {}
  Fault take(const Place& place) noexcept {
    if (place.width_bits < 1 || place.width_bits > 64) return Fault::width;
    if (place.is_float && place.width_bits != 32) return Fault::width;
    const bool whole_bytes = place.offset_bits % 8 == 0 && place.width_bits % 8 == 0;
    if ((place.endian == Endian::big || place.is_float) && !whole_bytes) return Fault::alignment;
    if (place.offset_bits > bits_ || place.width_bits > bits_ - place.offset_bits)
      return Fault::overrun;
    for (std::size_t bit = place.offset_bits; bit < place.offset_bits + place.width_bits; ++bit) {
      if (taken_[bit]) return Fault::overlap;
      taken_[bit] = true;
    }
    return Fault::none;
  }

 private:
  std::size_t bits_;
  std::bitset<kMostReportBytes * 8> taken_{};
};

Fault frame_fault(std::optional<std::uint8_t> id, std::size_t bytes, std::size_t fields) noexcept {
  if (bytes < (id ? 2U : 1U) || bytes > kMostReportBytes) return Fault::report_length;
  if (id && *id == 0) return Fault::report_id;
  return fields > kMostFields ? Fault::too_many_fields : Fault::none;
}

constexpr Place kIdPlace{.offset_bits = 0, .width_bits = 8};

/// So that every number the place can hold has a finite value.
bool legal_scale(double scale, double offset, const Place& place) noexcept {
  const double most = place.is_float
                          ? std::abs(scale) * double{std::numeric_limits<float>::max()}
                          : std::ldexp(std::abs(scale), static_cast<int>(place.width_bits));
  return scale != 0 && std::isfinite(most + std::abs(offset));
}

bool legal_modulus(std::uint64_t modulus, const Place& place) noexcept {
  return !place.is_float && place.width_bits <= 32 && modulus >= 2 && modulus <= kMostModulus &&
         modulus <= std::uint64_t{1} << place.width_bits;
}

Fault field_fault(const InputField& field, Taken& taken) noexcept {
  if (const Fault fault = taken.take(field.place); fault != Fault::none) return fault;
  if (!legal_scale(field.scale, field.offset, field.place)) return Fault::scale;
  if (field.modulus && !legal_modulus(*field.modulus, field.place)) return Fault::modulus;
  return Fault::none;
}

Fault sequence_fault(const SequenceField& field, Taken& taken) noexcept {
  if (const Fault fault = taken.take(field.place); fault != Fault::none) return fault;
  const bool counts = !field.place.is_signed && field.place.width_bits <= 32 &&
                      legal_modulus(field.steps(), field.place);
  return counts ? Fault::none : Fault::modulus;
}

Fault field_fault(const OutputField& field, Taken& taken) noexcept {
  if (const Fault fault = taken.take(field.place); fault != Fault::none) return fault;
  if (!legal_scale(field.scale, field.offset, field.place)) return Fault::scale;
  if (!(field.least <= field.most)) return Fault::limits;
  return Fault::none;
}

Fault rest_fault(const OutputMap& map, Taken& taken) noexcept {
  for (const ConstantByte& constant : map.constants) {
    if (constant.at >= map.report_bytes) return Fault::overrun;
    const Place place{.offset_bits = static_cast<std::uint32_t>(constant.at * 8), .width_bits = 8};
    if (const Fault fault = taken.take(place); fault != Fault::none) return fault;
  }
  if (map.heartbeat) {
    if (map.heartbeat->is_float) return Fault::width;
    if (const Fault fault = taken.take(*map.heartbeat); fault != Fault::none) return fault;
  }
  if (map.safe.empty()) return Fault::none;
  const bool fits =
      map.safe.size() == map.report_bytes && (!map.report_id || map.safe.front() == *map.report_id);
  return fits ? Fault::none : Fault::safe_report;
}

/// Of both maps: the frame, the id, each field.
template <class Map>
Problem fields_problem(const Map& map, Taken& taken) noexcept {
  if (map.report_id) taken.take(kIdPlace);
  for (std::size_t i = 0; i < map.fields.size(); ++i)
    if (const Fault fault = field_fault(map.fields[i], taken); fault != Fault::none)
      return {fault, i};
  return {Fault::none, kMostFields};
}

/// Of a map that is good but for this.
Problem zero_problem(const OutputMap& map) noexcept {
  const std::array<double, kMostFields> zeros{};
  const auto encoded = encode(map, std::span(zeros).first(map.fields.size()), 0);
  if (!encoded || encoded->saturated == 0) return {Fault::none, kMostFields};
  return {Fault::no_zero, static_cast<std::size_t>(std::countr_zero(encoded->saturated))};
}

/// Does the safe report ask for a force, more than a step of it?
bool safe_pushes(const OutputMap& map) noexcept {
  if (map.safe.empty()) return false;
  InputMap same{.report_id = map.report_id, .report_bytes = map.report_bytes};
  for (const OutputField& field : map.fields)
    same.fields.push_back({.place = field.place, .scale = field.scale, .offset = field.offset});
  const Reading safe = decode(same, map.safe);
  if (safe.received != Received::ok) return true;
  for (std::size_t i = 0; i < map.fields.size(); ++i) {
    const OutputField& field = map.fields[i];
    const double most = field.place.is_float ? 0 : std::abs(field.scale);
    if (!(std::abs(safe.value[i]) <= most)) return true;
  }
  return false;
}

}  // namespace

std::string_view words(Fault fault) noexcept {
  switch (fault) {
    case Fault::none:
      return {};
    case Fault::report_length:
      return "a report has 1 to 64 bytes, and one besides its id";
    case Fault::report_id:
      return "a report id is 1 to 255";
    case Fault::too_many_fields:
      return "at most 16 fields";
    case Fault::width:
      return "a field has 1 to 64 bits, a floating-point number 32, and a heartbeat is none";
    case Fault::alignment:
      return "a big endian field and a floating-point number are of whole bytes";
    case Fault::overrun:
      return "runs beyond the report";
    case Fault::overlap:
      return "bits are used twice";
    case Fault::scale:
      return "scale must be finite and not 0, offset finite, and so all values";
    case Fault::modulus:
      return "a modulus is at least 2 and no more than an unsigned number of so many bits, at most "
             "32, can count; a floating-point number has none";
    case Fault::limits:
      return "limits are not in order";
    case Fault::no_zero:
      return "0 cannot be sent";
    case Fault::safe_report:
      return "the safe report has another length or id than the report, or asks for an effort";
  }
  return {};
}

Problem check(const InputMap& map) noexcept {
  const Fault frame = frame_fault(map.report_id, map.report_bytes, map.fields.size());
  if (frame != Fault::none) return {frame, kMostFields};
  Taken taken(map.report_bytes);
  if (const Problem problem = fields_problem(map, taken); problem.fault != Fault::none)
    return problem;
  return {map.sequence ? sequence_fault(*map.sequence, taken) : Fault::none, kMostFields};
}

Problem check(const OutputMap& map) noexcept {
  const Fault frame = frame_fault(map.report_id, map.report_bytes, map.fields.size());
  if (frame != Fault::none) return {frame, kMostFields};
  Taken taken(map.report_bytes);
  if (const Problem problem = fields_problem(map, taken); problem.fault != Fault::none)
    return problem;
  if (const Fault fault = rest_fault(map, taken); fault != Fault::none) return {fault, kMostFields};
  if (safe_pushes(map)) return {Fault::safe_report, kMostFields};
  return zero_problem(map);
}

}  // namespace hapticd::hid
