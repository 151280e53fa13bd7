// HID report descriptors (Device Class Definition for HID 1.11, section 6.2.2), as far as a map has to be checked against
// one: which reports there are, how many bits each has, which usage lies where. For set-up; what a device sends here is
// not trusted. Pure: no HID, no clock.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "control/core/result.h"
#include "drivers/hid/report_map.h"

namespace hapticd::hid {

enum class ReportKind : std::uint8_t { input, output, feature };

/// Usage page << 16 | usage.
using Usage = std::uint32_t;
struct UsageRange {
  Usage first = 0, last = 0;
};

/// One Input, Output or Feature item: `count` elements of `element_bits`, one after the other.
struct ReportField {
  ReportKind kind = ReportKind::input;
  std::uint8_t report_id = 0;     ///< 0: reports have no ids
  std::uint32_t offset_bits = 0;  ///< as Place has it: after the id
  std::uint32_t element_bits = 0;
  std::uint32_t count = 0;
  bool constant = false;  ///< padding
  bool variable = false;  ///< an element has a usage; else it selects one
  std::int64_t logical_least = 0, logical_most = 0;
  std::vector<UsageRange> usages{};  ///< of the elements in order; the last holds for the rest
};

struct ReportDescriptor {
  bool numbered = false;
  std::vector<ReportField> fields{};
  std::vector<Usage> applications{};  ///< of the top collections, in order
  /// By kind and id, with the 8 of the id; 0: there is no such report.
  std::array<std::array<std::uint32_t, 256>, 3> report_bits{};

  /// With the id; 0: there is no such report. `id` 0: reports have no ids.
  std::size_t report_bytes(ReportKind kind, std::uint8_t id) const noexcept {
    return (std::size_t{report_bits[static_cast<std::size_t>(kind)][id]} + 7) / 8;
  }
};

// Beyond these a descriptor is refused; Linux has the same.
inline constexpr std::size_t kMostDescriptorBytes = 4096;
inline constexpr std::size_t kMostDescribedFields = 256;
inline constexpr std::uint32_t kMostElementBits = 256;
inline constexpr std::uint32_t kMostReportBits = 8 * 4096;

/// Errors (unavailable) name the byte: an item that is cut off, collections that do not close, push and pop that do not
/// match, an id of 0 or fields both with and without ids, more than the limits.
Result<ReportDescriptor> parse_descriptor(std::span<const std::uint8_t> bytes);

struct Found {
  std::uint8_t report_id = 0;
  Place place{};  ///< signed where the logical minimum is below 0
};
/// The first variable element of that usage; nothing: there is none, or it has more than 64 bits.
std::optional<Found> find(const ReportDescriptor& descriptor, ReportKind kind,
                          Usage usage) noexcept;

enum class Fit : std::uint8_t {
  ok,
  no_such_report,  ///< of that id; or the map has one and the device has none, or the other way round
  report_length,  ///< is another than the map's
  outside,        ///< a field beyond the last bit that the report declares
};
/// Does a map that is good in itself match the device? Feature reports are not mapped.
Fit fit(const ReportDescriptor& descriptor, const InputMap& map) noexcept;
Fit fit(const ReportDescriptor& descriptor, const OutputMap& map) noexcept;

}  // namespace hapticd::hid
