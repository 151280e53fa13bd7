// Numbers at places in a report, as a board's firmware packs them.
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace hapticd::sim::usb {

/// Little endian: bit 0 of the number is at `offset`, counted from the lowest bit of the first byte. Big endian: whole
/// bytes only, the first one counts most.
struct ReportField {
  std::size_t offset_bits = 0;  ///< from the byte after the report id
  unsigned width_bits = 16;     ///< 1..64
  bool is_signed = true;
  bool big_endian = false;
};

/// The lowest `width_bits` of `value`: it wraps, as counters do.
void put_field(std::span<std::uint8_t> report, const ReportField& field, std::int64_t value);
/// Sign extended if signed.
std::int64_t get_field(std::span<const std::uint8_t> report, const ReportField& field);

}  // namespace hapticd::sim::usb
