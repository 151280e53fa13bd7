#include "drivers/hid/openffboard_layout.h"

#include <algorithm>
#include <bit>
#include <string>

#include "drivers/hid/openffboard_codec.h"

namespace hapticd::hid::openffboard {
namespace {

constexpr std::uint8_t kSetEffectReport = 1;

constexpr Usage kFirstButton = 0x0009'0001, kDirectionEnable = 0x000f'0056;
/// X Y Z RX RY RZ dial slider, in the order of report 1.
constexpr std::array<Usage, 8> kAxisUsages{0x0001'0030, 0x0001'0031, 0x0001'0032, 0x0001'0033,
                                           0x0001'0034, 0x0001'0035, 0x0001'0037, 0x0001'0036};
constexpr std::uint32_t kEnableByte = 13;  // of Set Effect: axes, and behind them the direction
constexpr std::size_t kMostAnalogue = 6;

/// Reports whose layout all builds share.
struct Expected {
  ReportKind kind;
  std::uint8_t id;
  std::size_t bytes;
  const char* name;
};
constexpr std::array<Expected, 9> kExpected{{
    {ReportKind::input, 0x02, 2, "state"},
    {ReportKind::input, kCommandReport, kCommandBytes, "command answer"},
    {ReportKind::output, kCommandReport, kCommandBytes, "command"},
    {ReportKind::output, 0x05, 4, "constant force"},
    {ReportKind::output, 0x0a, 4, "effect operation"},
    {ReportKind::output, 0x0c, 2, "device control"},
    {ReportKind::output, 0x0d, 2, "device gain"},
    {ReportKind::feature, 0x11, 4, "new effect"},
    {ReportKind::feature, kBlockLoadReport, 5, "block load"},
}};

tl::unexpected<Error> refuse(const std::string& text) {
  return fail(ExitCode::unavailable,
              "its report descriptor is not one of an OpenFFBoard with force feedback: " + text +
                  "; select a main class with force feedback (FFB wheel or joystick) on the board");
}

std::string number(std::size_t value) {
  return std::to_string(value);
}

/// The first report with another length than expected.
const Expected* amiss(const ReportDescriptor& descriptor) {
  const auto wrong = [&](const Expected& report) {
    return descriptor.report_bytes(report.kind, report.id) != report.bytes;
  };
  const auto* found = std::find_if(kExpected.begin(), kExpected.end(), wrong);
  return found == kExpected.end() ? nullptr : found;
}

/// The largest number of the element at that place.
std::int64_t most_at(const ReportDescriptor& descriptor, const Found& found) {
  for (const ReportField& field : descriptor.fields) {
    const std::uint64_t end = field.offset_bits + std::uint64_t{field.element_bits} * field.count;
    const bool here = field.kind == ReportKind::input && field.report_id == found.report_id &&
                      field.offset_bits <= found.place.offset_bits && found.place.offset_bits < end;
    if (here) return field.logical_most;
  }
  return 0;
}

struct Axis {
  Place place{};
  std::int64_t most = 0;
};
std::optional<Axis> axis_at(const ReportDescriptor& descriptor, Usage usage) {
  const auto found = find(descriptor, ReportKind::input, usage);
  if (!found || found->report_id != kGamepadReport || !found->place.is_signed) return std::nullopt;
  const Axis axis{found->place, most_at(descriptor, *found)};
  // A whole number of bits, of which there are at least enough to feel.
  const bool good =
      axis.most >= 0x7ff && std::has_single_bit(static_cast<std::uint64_t>(axis.most) + 1);
  return good ? std::optional(axis) : std::nullopt;
}

/// How many axes with force the build has: where the bit is that enables a direction. 0: not known.
int force_axes_of(const ReportDescriptor& descriptor) {
  const auto enable = find(descriptor, ReportKind::output, kDirectionEnable);
  if (!enable || enable->report_id != kSetEffectReport) return 0;
  const std::uint32_t bit = enable->place.offset_bits - 8 * kEnableByte;
  return bit == 1 || bit == 2 ? static_cast<int>(bit) : 0;
}

void add_buttons(const ReportDescriptor& descriptor, Layout& layout) {
  const auto first = find(descriptor, ReportKind::input, kFirstButton);
  if (!first || first->report_id != kGamepadReport || first->place.width_bits != 1) return;
  const std::uint32_t bits = 8 * static_cast<std::uint32_t>(layout.gamepad.report_bytes);
  const std::uint32_t left = bits - std::min(bits, first->place.offset_bits);
  // Up to the axes, which follow.
  std::uint32_t end = std::min(32U, left);
  for (const InputField& field : layout.gamepad.fields)
    if (field.place.offset_bits > first->place.offset_bits)
      end = std::min(end, field.place.offset_bits - first->place.offset_bits);
  layout.gamepad.fields.push_back(
      {.place = {.offset_bits = first->place.offset_bits, .width_bits = end}});
  layout.buttons = true;
}

void add_analogue(const ReportDescriptor& descriptor, Layout& layout) {
  std::size_t added = 0;
  for (std::size_t i = static_cast<std::size_t>(layout.force_axes);
       i < kAxisUsages.size() && added < kMostAnalogue; ++i) {
    const auto axis = axis_at(descriptor, kAxisUsages[i]);
    if (!axis) continue;
    layout.gamepad.fields.push_back(
        {.place = axis->place, .scale = 1 / static_cast<double>(axis->most)});
    ++added;
  }
}

/// Empty: no error.
std::string add_positions(const ReportDescriptor& descriptor, Layout& layout) {
  for (std::size_t i = 0; i < layout.axes; ++i) {
    const auto axis = axis_at(descriptor, kAxisUsages[i]);
    if (!axis)
      return std::string("expected in input report 1 a signed axis ") + (i == 0 ? "X" : "Y") +
             " of 12 to 32 bits, found none";
    layout.gamepad.fields.push_back({.place = axis->place});
    layout.counts_of_range[i] = 2 * (static_cast<double>(axis->most) + 1);
  }
  return {};
}

}  // namespace

Result<Layout> layout_of(const ReportDescriptor& descriptor, std::size_t axes) {
  if (const Expected* report = amiss(descriptor))
    return refuse("expected report " + number(report->id) + " (" + report->name + ") with " +
                  number(report->bytes) + " bytes, found " +
                  number(descriptor.report_bytes(report->kind, report->id)));
  Layout layout{.axes = axes, .force_axes = force_axes_of(descriptor)};
  if (layout.force_axes == 0)
    return refuse(
        "expected in Set Effect (report 1) the bit that enables a direction behind 1 or 2 axes");
  if (axes < 1 || axes > static_cast<std::size_t>(layout.force_axes))
    return refuse("expected " + number(axes) + " axes with force as configured, found " +
                  number(static_cast<std::size_t>(layout.force_axes)));
  layout.set_effect_bytes = descriptor.report_bytes(ReportKind::output, kSetEffectReport);
  if (layout.set_effect_bytes < (layout.force_axes == 2 ? 18U : 16U) ||
      layout.set_effect_bytes > kMostSetEffectBytes)
    return refuse("Set Effect (report 1) has " + number(layout.set_effect_bytes) + " bytes");
  layout.gamepad = {.report_id = kGamepadReport,
                    .report_bytes = descriptor.report_bytes(ReportKind::input, kGamepadReport)};
  if (const std::string why = add_positions(descriptor, layout); !why.empty()) return refuse(why);
  add_buttons(descriptor, layout);
  add_analogue(descriptor, layout);
  if (const Problem problem = check(layout.gamepad); problem.fault != Fault::none)
    return refuse("input report 1 cannot be used: " + std::string(words(problem.fault)));
  return layout;
}

}  // namespace hapticd::hid::openffboard
