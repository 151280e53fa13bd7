// The reports of a HID device of one's own: keys to the maps of drivers/hid, and what is wrong with them at its key.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "config/compile_usb.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

hid::Place place_of(const BitField& field) {
  return {.offset_bits = static_cast<std::uint32_t>(field.offset_bits),
          .width_bits = static_cast<std::uint32_t>(field.width_bits),
          .endian = static_cast<hid::Endian>(field.endian)};
}
hid::Place number_place(const NumberField& field) {
  hid::Place place = place_of(field);
  place.is_signed = field.is_signed;
  place.is_float = field.is_float;
  return place;
}

std::optional<std::uint8_t> report_id(const std::optional<int>& id) {
  if (!id) return {};
  return static_cast<std::uint8_t>(*id);
}

/// After so many steps a counter begins anew.
std::uint64_t modulus_of(const PositionField& field) {
  constexpr int kMostBits = 63;  // more is refused; this is not to overflow before
  return field.modulus ? static_cast<std::uint64_t>(*field.modulus)
                       : std::uint64_t{1} << std::min(field.width_bits, kMostBits);
}

hid::InputMap input_map(const ReportIn& in) {
  hid::InputMap map{.report_id = report_id(in.id),
                    .report_bytes = static_cast<std::size_t>(in.bytes),
                    .fields = {},
                    .sequence = {}};
  for (const PositionField& field : in.positions) {
    map.fields.push_back({.place = number_place(field),
                          .scale = field.scale,
                          .offset = field.offset,
                          .modulus = {}});
    if (field.unwrap) map.fields.back().modulus = modulus_of(field);
  }
  for (const ButtonField& field : in.buttons)
    map.fields.push_back(
        {.place = place_of({field.offset_bits, field.width_bits, ByteOrder::little}),
         .modulus = {}});
  for (const AnalogueField& field : in.analogue)
    map.fields.push_back({.place = number_place(field),
                          .scale = field.scale,
                          .offset = field.offset,
                          .modulus = {}});
  if (in.sequence)
    map.sequence = {.place = place_of(*in.sequence),
                    .modulus = static_cast<std::uint64_t>(in.sequence->modulus.value_or(0))};
  return map;
}

hid::OutputMap output_map(const ReportOut& out) {
  hid::OutputMap map{.report_id = report_id(out.id),
                     .report_bytes = static_cast<std::size_t>(out.bytes),
                     .fields = {},
                     .constants = {},
                     .heartbeat = {},
                     .safe = {}};
  for (const EffortField& field : out.efforts) {
    map.fields.push_back(
        {.place = number_place(field), .scale = field.scale, .offset = field.offset});
    if (field.least) map.fields.back().least = *field.least;
    if (field.most) map.fields.back().most = *field.most;
  }
  for (const ConstantByte& constant : out.constants)
    map.constants.push_back({.at = static_cast<std::size_t>(constant.byte),
                             .value = static_cast<std::uint8_t>(constant.value)});
  if (out.heartbeat) map.heartbeat = place_of(*out.heartbeat);
  for (const int byte : out.safe) map.safe.push_back(static_cast<std::uint8_t>(byte));
  return map;
}

// -- what is wrong with them

/// The key of a field that a fault is about.
const char* key_of(hid::Fault fault) {
  switch (fault) {
    case hid::Fault::width:
      return ".width_bits";
    case hid::Fault::scale:
      return ".scale";
    case hid::Fault::modulus:
      return ".modulus";
    case hid::Fault::limits:
      return ".most";
    case hid::Fault::no_zero:
      return ".offset";
    case hid::Fault::alignment:
    case hid::Fault::overrun:
    case hid::Fault::overlap:
      return ".offset_bits";
    case hid::Fault::none:
    case hid::Fault::report_length:
    case hid::Fault::report_id:
    case hid::Fault::too_many_fields:
    case hid::Fault::safe_report:
      break;
  }
  return "";
}

std::string bits_text(const hid::Place& place, std::size_t report_bytes) {
  return ": bits " + std::to_string(place.offset_bits) + " to " +
         std::to_string(place.offset_bits + place.width_bits - 1) + " of " +
         std::to_string(8 * report_bytes) + ", counted from the report's first byte";
}

/// A fault in words, with the bits that it is about.
template <class Map>
std::string fault_text(const Map& map, const hid::Problem& problem) {
  std::string text(hid::words(problem.fault));
  const bool of_bits = std::string_view(key_of(problem.fault)) == ".offset_bits";
  if (!of_bits || problem.field >= map.fields.size()) return text;
  if (problem.fault == hid::Fault::overlap && map.report_id) text += " (an id takes bits 0 to 7)";
  return text + bits_text(map.fields[problem.field].place, map.report_bytes);
}

std::string input_key(const ReportIn& in, const hid::Problem& problem) {
  const std::size_t buttons = in.positions.size(), analogue = buttons + in.buttons.size();
  const std::string key = key_of(problem.fault);
  if (problem.fault == hid::Fault::report_length) return "bytes";
  if (problem.fault == hid::Fault::report_id) return "id";
  if (problem.fault == hid::Fault::too_many_fields) return "buttons";
  if (problem.field < buttons) return indexed("positions", problem.field) + key;
  if (problem.field < analogue) return indexed("buttons", problem.field - buttons) + key;
  if (problem.field < analogue + in.analogue.size())
    return indexed("analogue", problem.field - analogue) + key;
  return "sequence" + key;
}

std::string output_key(const hid::OutputMap& map, const hid::Problem& problem) {
  const std::string key = key_of(problem.fault);
  if (problem.fault == hid::Fault::report_length) return "bytes";
  if (problem.fault == hid::Fault::report_id) return "id";
  if (problem.fault == hid::Fault::too_many_fields) return "efforts";
  if (problem.fault == hid::Fault::safe_report) return "safe";
  if (problem.field < map.fields.size()) return indexed("efforts", problem.field) + key;
  hid::OutputMap silent = map;
  silent.heartbeat.reset();
  return hid::check(silent) == problem ? "constants" : "heartbeat" + key;
}

/// A floating-point number has a sign of its own.
void check_signs(const UsbPlace& place, const Report& report) {
  const auto check = [&](const auto& fields, const char* list) {
    for (std::size_t i = 0; i < fields.size(); ++i) {
      if (!fields[i].is_float || !fields[i].is_signed) continue;
      place.refuse(indexed(list, i) + ".signed",
                   "a floating-point number has a sign of its own; remove this key");
    }
  };
  check(report.in.positions, "report.in.positions");
  check(report.in.analogue, "report.in.analogue");
  check(report.out.efforts, "report.out.efforts");
}

/// One for each axis, in both reports.
bool check_counts(const UsbPlace& place, const Report& report) {
  const std::size_t axes = place.device.axes.size();
  const auto check = [&](const char* key, std::size_t found) {
    if (found == axes) return true;
    place.refuse(key, "expected one for each of the " + std::to_string(axes) + " axes, found " +
                          std::to_string(found));
    return false;
  };
  const bool in = check("report.in.positions", report.in.positions.size());
  return check("report.out.efforts", report.out.efforts.size()) && in;
}

bool check_maps(const UsbPlace& place, const Report& report, const usb::ReportOptions& options) {
  const hid::Problem in = hid::check(options.in), out = hid::check(options.out);
  if (in.fault != hid::Fault::none)
    place.refuse("report.in." + input_key(report.in, in), fault_text(options.in, in));
  if (out.fault != hid::Fault::none)
    place.refuse("report.out." + output_key(options.out, out), fault_text(options.out, out));
  return in.fault == hid::Fault::none && out.fault == hid::Fault::none;
}

// -- what the axes need of them

/// Who counts on where a counter begins anew: the driver, told by unwrap, or the loop, told by encoder.bits.
void check_bits(const UsbPlace& place, std::size_t i, const PositionField& field) {
  constexpr int kUsual = 32;
  const int bits = place.device.device.axes[i].encoder.bits;
  const std::string key = indexed("report.in.positions", i);
  if (bits == 0) return;
  if (field.unwrap) {
    if (bits == kUsual) return;
    place.refuse_axis(i, "encoder.bits",
                      "expected 0, or nothing: " + key + ".unwrap counts on already; found " +
                          std::to_string(bits));
  } else if (field.is_float) {
    place.refuse_axis(
        i, "encoder.bits",
        "expected 0: a floating-point number does not begin anew; found " + std::to_string(bits));
  } else if (bits != field.width_bits) {
    place.refuse_axis(i, "encoder.bits",
                      "expected " + std::to_string(field.width_bits) + ", as " + key +
                          ".width_bits says; or 0 if it never begins anew; or " + key +
                          ".unwrap: true; found " + std::to_string(bits));
  } else if (std::abs(field.scale) != 1) {
    place.refuse_axis(i, "encoder.bits",
                      "expected 0: scaled by " + format_number(field.scale) +
                          " the counts do not begin anew after 2^" + std::to_string(bits) +
                          "; use " + key + ".unwrap: true if the number does");
  }
}

/// As compile_axis() has it for encoder.bits: a jump is less than half of the range.
void check_unwrap(const UsbPlace& place, std::size_t i, const PositionField& field) {
  if (!field.unwrap) {
    if (field.modulus)
      place.refuse(indexed("report.in.positions", i) + ".modulus",
                   "it has a meaning with unwrap: true alone; add that, or remove this key");
    return;
  }
  const AxisValues& values = place.device.axes[i];
  const double steps = kMaxStepTicks * values.max_velocity * place.compilation.spec.period_s *
                       values.counts_per_unit / std::abs(field.scale);
  const auto modulus = static_cast<double>(modulus_of(field));
  if (!(2 * steps >= modulus)) return;
  place.refuse(indexed("report.in.positions", i) + (field.modulus ? ".modulus" : ".width_bits"),
               "at guard." +
                   std::string(values.rotary ? "max_velocity_rad_s " : "max_velocity_m_s ") +
                   format_number(values.max_velocity) + " a counter of " + format_number(modulus) +
                   " steps could begin anew unnoticed, at " + format_number(std::ceil(steps)) +
                   " in 10 ticks; lower that limit, or use more bits");
}

/// First and last number of a field.
std::array<double, 2> range_of(const NumberField& field) {
  constexpr double kMostFloat = std::numeric_limits<float>::max();
  if (field.is_float) return {-kMostFloat, kMostFloat};
  const double steps = std::ldexp(1.0, field.width_bits);
  if (field.is_signed) return {-steps / 2, steps / 2 - 1};
  return {0, steps - 1};
}

/// The largest effort that a field has both ways.
double carried_effort(const EffortField& field) {
  const std::array<double, 2> range = range_of(field);
  const auto [least, most] =
      std::minmax({range[0] * field.scale + field.offset, range[1] * field.scale + field.offset});
  return std::min(std::min(most, field.most.value_or(most)),
                  -std::max(least, field.least.value_or(least)));
}

void check_times(const UsbPlace& place, const ReportOut& out) {
  if (!out.watchdog_s || out.every_s <= *out.watchdog_s / 3) return;
  place.refuse("report.out.every_s",
               "expected at most a third of watchdog_s, " + format_number(*out.watchdog_s / 3) +
                   " s, so that a late report does not switch the device off; "
                   "found " +
                   format_number(out.every_s) + " s");
}

}  // namespace

usb::ReportOptions compile_report(const UsbPlace& place) {
  const Report& report = *place.device.device.report;
  usb::ReportOptions options{.in = input_map(report.in),
                             .out = output_map(report.out),
                             .buttons = report.in.buttons.size(),
                             .every_s = report.out.every_s};
  check_times(place, report.out);
  check_signs(place, report);
  if (!check_counts(place, report) || !check_maps(place, report, options)) return options;
  for (std::size_t i = 0; i < place.device.axes.size(); ++i) {
    check_bits(place, i, report.in.positions[i]);
    check_unwrap(place, i, report.in.positions[i]);
    check_effort(place, i, carried_effort(report.out.efforts[i]), indexed("report.out.efforts", i));
  }
  return options;
}

}  // namespace hapticd::config
