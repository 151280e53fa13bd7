#include "sim/usb/report_layout.h"

namespace hapticd::sim::usb {
namespace {

/// Where bit i of a number, counted from the lowest, is in the report.
std::size_t bit_in_report(const ReportField& field, std::size_t i) {
  if (!field.big_endian) return field.offset_bits + i;
  const std::size_t last_byte = field.width_bits / 8 - 1;
  return field.offset_bits + 8 * (last_byte - i / 8) + i % 8;
}

}  // namespace

void put_field(std::span<std::uint8_t> report, const ReportField& field, std::int64_t value) {
  const auto bits = static_cast<std::uint64_t>(value);
  for (std::size_t i = 0; i < field.width_bits; ++i) {
    const std::size_t bit = bit_in_report(field, i);
    if (bit / 8 >= report.size()) continue;
    const auto mask = static_cast<std::uint8_t>(1u << bit % 8);
    std::uint8_t& byte = report[bit / 8];
    byte = static_cast<std::uint8_t>(bits >> i & 1 ? byte | mask : byte & ~mask);
  }
}

std::int64_t get_field(std::span<const std::uint8_t> report, const ReportField& field) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < field.width_bits; ++i) {
    const std::size_t bit = bit_in_report(field, i);
    if (bit / 8 < report.size() && report[bit / 8] >> bit % 8 & 1) bits |= std::uint64_t{1} << i;
  }
  const std::uint64_t sign = std::uint64_t{1} << (field.width_bits - 1);
  if (field.is_signed && bits & sign) bits |= ~(sign - 1);
  return static_cast<std::int64_t>(bits);
}

}  // namespace hapticd::sim::usb
