// Reports of fixed layout that a HID device of one's own has: which bits are which number. Pure: no HID, no clock; no heap
// once a map is made.
//
// Offsets count from the first byte of a report as the wire has it: a numbered report begins with its id, which is bits 0
// to 7; one without ids begins with its data. value = raw * scale + offset.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace hapticd::hid {

/// Of one interrupt transfer at full speed.
inline constexpr std::size_t kMostReportBytes = 64;
inline constexpr std::size_t kMostFields = 16;

enum class Endian : std::uint8_t { little, big };

/// Where a number lies. Little endian: `offset_bits` is its lowest bit, and bit 0 the lowest of byte 0. Big endian: whole
/// bytes, `offset_bits` the first of its first byte.
struct Place {
  std::uint32_t offset_bits = 0;
  std::uint32_t width_bits = 0;  ///< 1 to 64
  bool is_signed = false;        ///< two's complement
  Endian endian = Endian::little;
  bool is_float = false;  ///< IEEE 754 binary32 in whole bytes: 32 bits, its sign is its own
  bool operator==(const Place&) const = default;
};

/// The number's bits, the lowest at bit 0, the rest 0. Precondition: a legal place inside `report`.
std::uint64_t read_bits(std::span<const std::uint8_t> report, const Place& place) noexcept;
/// Puts the lowest bits of `bits` there and leaves the other bits of `report` alone. Precondition: as read_bits().
void write_bits(std::span<std::uint8_t> report, const Place& place, std::uint64_t bits) noexcept;
/// As read_bits(), with the sign extended. An unsigned number of 64 bits comes as its bits, and a float as its 32.
std::int64_t read_raw(std::span<const std::uint8_t> report, const Place& place) noexcept;

/// What is wrong with a map.
enum class Fault : std::uint8_t {
  none,
  report_length,  ///< 0, more than kMostReportBytes, or an id and no data
  report_id,      ///< 0 is none
  too_many_fields,
  width,        ///< 0 or more than 64; a float of not 32, or as heartbeat
  alignment,    ///< big endian or a float, and not whole bytes
  overrun,      ///< bits beyond the report
  overlap,      ///< with another field, the id, a constant, the heartbeat or the sequence number
  scale,        ///< 0; or it, the offset, or the value of some number is not finite
  modulus,      ///< less than 2, more than the number can count, more than 32 bits, or of a float
  limits,       ///< not in order, or NaN
  no_zero,      ///< value 0 is beyond the limits or the number: there is no way to say "no force"
  safe_report,  ///< another length or id than the report, or more than a step of an effort
};
struct Problem {
  Fault fault = Fault::none;
  std::size_t field = 0;  ///< which one where it is about a field; else kMostFields
  bool operator==(const Problem&) const = default;
};
/// In words; empty: none.
std::string_view words(Fault fault) noexcept;

// -- from the device

struct InputField {
  Place place{};
  double scale = 1, offset = 0;
  /// A counter of so many steps that begins anew, 2^width for all its bits: is counted on over the end. Nothing: as it is.
  std::optional<std::uint64_t> modulus{};
};
/// A number that goes up by one in each report.
struct SequenceField {
  Place place{};              ///< unsigned
  std::uint64_t modulus = 0;  ///< 0: 2^width
  /// After how many it begins anew; check() refuses more than 2^32.
  std::uint64_t steps() const noexcept {
    return modulus != 0 ? modulus : std::uint64_t{1} << std::min(place.width_bits, 63U);
  }
};
struct InputMap {
  std::optional<std::uint8_t> report_id{};
  std::size_t report_bytes = 0;      ///< with the id
  std::vector<InputField> fields{};  ///< at most kMostFields
  std::optional<SequenceField> sequence{};
};
/// To be called once, before decode().
Problem check(const InputMap& map) noexcept;

enum class Received : std::uint8_t {
  ok,
  ignore,     ///< a report of another id
  malformed,  ///< another length than the map's
  out_of_range,  ///< a counter or a sequence number that its modulus does not have, or a float that is no number
};
struct Reading {
  Received received = Received::ignore;
  std::array<std::int64_t, kMostFields> raw{};  ///< by field, as read_raw(); where `ok`
  std::array<double, kMostFields> value{};      ///< by field, not counted over; where `ok`
  std::uint64_t sequence = 0;                   ///< where the map has one
};
/// `report`: as hidapi reads it.
Reading decode(const InputMap& map, std::span<const std::uint8_t> report) noexcept;

/// Counts on where a counter begins anew: right as long as it goes less than half its modulus between two readings.
class Unwrap {
 public:
  /// The count of this reading; of the first, the reading itself. `modulus`: 2 to 2^32, |raw| below it.
  std::int64_t step(std::int64_t raw, std::uint64_t modulus) noexcept;
  void restart() noexcept { started_ = false; }

 private:
  bool started_ = false;
  std::int64_t previous_ = 0, count_ = 0;
};

/// What a sequence number says of the reports.
class Sequence {
 public:
  enum class Order : std::uint8_t { first, next, repeated, lost, back };
  struct Step {
    Order order = Order::first;
    std::uint64_t lost = 0;  ///< reports between this one and the last; only where `lost`
  };
  /// More than half the modulus ahead counts as back: an old report, or a device that began anew. `number` below `modulus`.
  Step step(std::uint64_t number, std::uint64_t modulus) noexcept;
  void restart() noexcept { started_ = false; }

 private:
  bool started_ = false;
  std::uint64_t last_ = 0;
};

/// What has to be known of the reports before.
struct InputState {
  std::array<Unwrap, kMostFields> counters{};
  Sequence sequence{};
};
/// Replaces the values of counters in an `ok` reading by what they count over all readings, and says what the sequence
/// number says; `next` where the map has none.
Sequence::Step follow(const InputMap& map, InputState& state, Reading& reading) noexcept;

// -- to the device

struct OutputField {
  Place place{};
  double scale = 1, offset = 0;
  /// Clips there before it is converted; and at what the bits can hold afterwards.
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
};
struct ConstantByte {
  std::size_t at = 0;  ///< byte of the report
  std::uint8_t value = 0;
};
struct OutputMap {
  std::optional<std::uint8_t> report_id{};
  std::size_t report_bytes = 0;       ///< with the id
  std::vector<OutputField> fields{};  ///< at most kMostFields
  std::vector<ConstantByte> constants{};
  std::optional<Place> heartbeat{};
  /// Whole, with the id; the heartbeat is put in. Empty: every value 0.
  std::vector<std::uint8_t> safe{};
};
/// To be called once, before encode().
Problem check(const OutputMap& map) noexcept;

using ReportBytes = std::array<std::uint8_t, kMostReportBytes>;
struct Encoded {
  ReportBytes bytes{};
  std::size_t size = 0;
  std::array<std::int64_t, kMostFields> raw{};  ///< by field, as read_raw()
  std::uint32_t saturated = 0;                  ///< bit i: field i was clipped
  std::span<const std::uint8_t> report() const noexcept { return {bytes.data(), size}; }
};
/// One value a field, rounded half away from zero, a float to the nearest. `heartbeat`: its lowest bits are sent. Nothing: a value is not finite,
/// or their number is not that of the fields; send the safe report then.
std::optional<Encoded> encode(const OutputMap& map, std::span<const double> values,
                              std::uint64_t heartbeat) noexcept;
/// The value that encode() sends for this one, which is finite.
double carried(const OutputField& field, double value) noexcept;
/// What to send on stopping.
Encoded safe_report(const OutputMap& map, std::uint64_t heartbeat) noexcept;

/// A report as hidapi's write takes it: a 0 before one without id. Returns the part of `buffer` that is used.
std::span<const std::uint8_t> for_hidapi(
    const Encoded& encoded, bool numbered,
    std::array<std::uint8_t, kMostReportBytes + 1>& buffer) noexcept;

}  // namespace hapticd::hid
