// What a device says of its reports: any bytes, and real descriptors in which some are changed. It is refused in words, or
// sound: fields lie within their report one after the other, and what is found lies where a map may be made of it.
#include <vector>

#include "drivers/hid/openffboard_layout.h"
#include "drivers/hid/report_descriptor.h"
#include "tests/fuzz/protocol.h"
#include "tests/unit/usb/openffboard_descriptor.h"

namespace hapticd::fuzz {
namespace {

using namespace hid;
using Bytes = std::vector<std::uint8_t>;

Bytes descriptor_of(Input& input) {
  const std::uint8_t kind = input.byte();
  Bytes bytes;
  if (kind % 4 != 0)
    bytes = test::board_descriptor({.axes = 1 + (kind >> 2) % 2, .wide = (kind & 0x10) != 0});
  if (kind % 4 == 0 || kind % 4 == 3)
    for (int i = 0; i < 300 && !input.empty(); ++i) bytes.push_back(input.byte());
  if (kind % 4 == 2) bytes.resize(std::min<std::size_t>(bytes.size(), input.take<std::uint16_t>()));
  while (kind % 4 != 0 && !input.empty() && !bytes.empty())
    bytes[input.take<std::uint16_t>() % bytes.size()] = input.byte();
  return bytes;
}

void must_be_sound(const ReportDescriptor& descriptor) {
  must(!descriptor.fields.empty() && descriptor.fields.size() <= kMostDescribedFields, "fields");
  std::array<std::array<std::uint32_t, 256>, 3> end{};
  for (const ReportField& field : descriptor.fields) {
    const auto kind = static_cast<std::size_t>(field.kind);
    must(descriptor.numbered == (field.report_id != 0), "all have ids, or none has");
    must(field.element_bits > 0 && field.element_bits <= kMostElementBits && field.count > 0,
         "bits");
    std::uint32_t& at = end[kind][field.report_id];
    if (at == 0) at = descriptor.numbered ? 8 : 0;
    must(field.offset_bits == at, "fields follow each other");
    at += field.element_bits * field.count;
    must(at <= kMostReportBits, "within the longest report");
  }
  for (std::size_t kind = 0; kind < 3; ++kind)
    for (std::size_t id = 0; id < 256; ++id) {
      must(descriptor.report_bits[kind][id] == end[kind][id], "a report ends with its last field");
      const std::size_t bytes =
          descriptor.report_bytes(static_cast<ReportKind>(kind), static_cast<std::uint8_t>(id));
      must(bytes == (end[kind][id] + 7) / 8, "in whole bytes");
    }
}

/// Where a usage was found: a map of it alone must fit.
void must_fit(const ReportDescriptor& descriptor, ReportKind kind, Usage usage) {
  const auto found = find(descriptor, kind, usage);
  if (!found) return;
  must(found->place.width_bits >= 1 && found->place.width_bits <= 64, "a number");
  const std::size_t bytes = descriptor.report_bytes(kind, found->report_id);
  must(found->place.offset_bits + found->place.width_bits <= 8 * bytes, "within its report");
  const auto id = found->report_id != 0 ? std::optional(found->report_id) : std::nullopt;
  const InputMap in{.report_id = id, .report_bytes = bytes, .fields = {{.place = found->place}}};
  const OutputMap out{.report_id = id, .report_bytes = bytes, .fields = {{.place = found->place}}};
  if (kind == ReportKind::input) must(fit(descriptor, in) == Fit::ok, "a map of it fits");
  if (kind == ReportKind::output) must(fit(descriptor, out) == Fit::ok, "a map of it fits");
  InputMap longer = in;
  ++longer.report_bytes;
  if (kind == ReportKind::input) must(fit(descriptor, longer) != Fit::ok, "a longer one does not");
  if (bytes <= kMostReportBytes && kind == ReportKind::input)
    must(check(in).fault == Fault::none, "and is a good one");
}

void must_be_a_board(const openffboard::Layout& layout, const ReportDescriptor& descriptor) {
  must(check(layout.gamepad).fault == Fault::none, "its map is good");
  must(fit(descriptor, layout.gamepad) == Fit::ok, "and fits");
  must(layout.axes >= 1 && layout.axes <= static_cast<std::size_t>(layout.force_axes), "axes");
  must(layout.first_analogue() <= layout.gamepad.fields.size(), "fields for all");
  must(layout.gamepad.fields.size() - layout.first_analogue() <= 6, "and no more");
  must(layout.set_effect_bytes >= 16 && layout.set_effect_bytes <= 64, "a Set Effect that is sent");
  for (std::size_t i = 0; i < layout.axes; ++i)
    must(layout.counts_of_range[i] >= 4096 && layout.counts_of_range[i] <= 4294967296.0, "a range");
}

}  // namespace

void decode(Input& input) {
  const Bytes bytes = descriptor_of(input);
  const auto descriptor = parse_descriptor(bytes);
  if (!descriptor) return must(!descriptor.error().text.empty(), "refused in words");
  must_be_sound(*descriptor);
  for (const ReportField& field : descriptor->fields)
    if (!field.usages.empty())
      for (const Usage usage : {field.usages.front().first, field.usages.back().last})
        must_fit(*descriptor, field.kind, usage);
  for (std::size_t axes = bytes.size() % 2; axes < 4; axes += 2) {
    const auto layout = openffboard::layout_of(*descriptor, axes);
    if (layout)
      must_be_a_board(*layout, *descriptor);
    else
      must(!layout.error().text.empty(), "refused in words");
  }
}

/// Nothing is encoded: what is whole is read in full.
void encode(Input& input) {
  const std::uint8_t kind = input.byte();
  const int axes = 1 + kind % 2;
  const auto descriptor = parse_descriptor(
      test::board_descriptor({.axes = axes, .wide = (kind & 4) != 0, .offsets = kind / 8U % 3}));
  must(descriptor.has_value(), "a board's own descriptor is read");
  must(openffboard::layout_of(*descriptor, static_cast<std::size_t>(axes)).has_value(), "and fits");
}

}  // namespace hapticd::fuzz
