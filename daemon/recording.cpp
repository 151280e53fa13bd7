#include "daemon/recording.h"

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <tuple>
#include <unordered_set>
#include <utility>

#include "control/core/sample.h"
#include "control/record.h"
#include "control/recorded.h"

namespace hapticd::daemon {
namespace {

static_assert(std::endian::native == std::endian::little,
              "records are written as they stand in memory");

using control::PhaseTimes;
using control::RecordArray;
using control::RecordHeader;

void add(std::vector<Field>& fields, std::string name, const char* unit, const char* type,
         std::size_t offset) {
  fields.push_back({std::move(name), unit, type, static_cast<std::uint32_t>(offset)});
}

void add_header_fields(std::vector<Field>& fields) {
  constexpr std::size_t kPhases = offsetof(RecordHeader, phases);
  add(fields, "tick", "-", "i64", offsetof(RecordHeader, tick));
  add(fields, "time_ns", "ns", "i64", offsetof(RecordHeader, time_ns));
  add(fields, "missed_ticks", "-", "i64", offsetof(RecordHeader, missed_ticks));
  add(fields, "fault_found", "-", "f64", offsetof(RecordHeader, fault_found));
  add(fields, "fault_allowed", "-", "f64", offsetof(RecordHeader, fault_allowed));
  add(fields, "ramp", "-", "f64", offsetof(RecordHeader, ramp));
  add(fields, "wake_ns", "ns", "i32", kPhases + offsetof(PhaseTimes, wake_ns));
  add(fields, "collect_ns", "ns", "i32", kPhases + offsetof(PhaseTimes, collect_ns));
  add(fields, "step_ns", "ns", "i32", kPhases + offsetof(PhaseTimes, step_ns));
  add(fields, "command_ns", "ns", "i32", kPhases + offsetof(PhaseTimes, command_ns));
  add(fields, "limits", "-", "u32", offsetof(RecordHeader, limits));
  add(fields, "fault_axis", "-", "u16", offsetof(RecordHeader, fault_axis));
  add(fields, "fault_device", "-", "u16", offsetof(RecordHeader, fault_device));
  add(fields, "fault", "-", "u8", offsetof(RecordHeader, fault));
  add(fields, "host_fault", "-", "u8", offsetof(RecordHeader, host_fault));
  add(fields, "mode", "-", "u8", offsetof(RecordHeader, mode));
  add(fields, "flags", "-", "u8", offsetof(RecordHeader, flags));
  add(fields, "sequence", "-", "u32", offsetof(RecordHeader, sequence));
}

const char* unit_of(control::Quantity quantity, bool rotary) {
  switch (quantity) {
    case control::Quantity::position:
      return rotary ? "rad" : "m";
    case control::Quantity::velocity:
      return rotary ? "rad/s" : "m/s";
    case control::Quantity::effort:
      return rotary ? "N*m" : "N";
    case control::Quantity::metre:
      return "m";
    case control::Quantity::newton:
      return "N";
    case control::Quantity::joule:
      return "J";
    case control::Quantity::share:
      break;
  }
  return "-";
}

/// Element `i` of an array, if the plan has it.
void add_element(std::vector<Field>& fields, const std::string& name, const char* unit,
                 const char* type, RecordArray array, std::size_t i) {
  if (i < array.count) add(fields, name, unit, type, array.offset + i * field_bytes(type));
}

/// What the state has for the i-th axis, coordinate or device, by control/recorded.h.
void add_recorded(std::vector<Field>& fields, const std::vector<std::string>& owners,
                  const control::RecordLayout& layout, control::Per per,
                  const std::vector<bool>& rotary) {
  for (std::size_t i = 0; i < owners.size(); ++i) {
    for (const control::RecordedField& field : control::kRecorded) {
      if (field.per != per) continue;
      const char* unit = unit_of(field.quantity, i < rotary.size() && rotary[i]);
      add_element(fields, owners[i] + field.suffix, unit, "f64", layout.*field.layout, i);
    }
  }
}

/// What the input had for each axis.
void add_input_fields(std::vector<Field>& fields, const build::ProgramSpec& spec,
                      const control::RecordLayout& layout) {
  for (std::size_t i = 0; i < spec.axis_names.size(); ++i) {
    const std::string& axis = spec.axis_names[i];
    const bool rotary = i < spec.rotary.size() && spec.rotary[i];
    add_element(fields, axis + ".raw", "-", "f64", layout.raw, i);
    add_element(fields, axis + ".age_ns", "ns", "i64", layout.age_ns, i);
    add_element(fields, axis + ".freshness", "-", "u8", layout.freshness, i);
    add_element(fields, axis + ".homed", "-", "u8", layout.homed, i);
    add_element(fields, axis + ".drive_limits", "-", "u16", layout.drive_limits, i);
    add_element(fields, axis + ".drive_faults", "-", "u32", layout.drive_faults, i);
    add_element(fields, axis + ".delivered", unit_of(control::Quantity::effort, rotary), "f64",
                layout.delivered, i);
  }
}

void add_aux_fields(std::vector<Field>& fields, const std::vector<std::string>& devices,
                    RecordArray aux) {
  for (std::size_t i = 0; i < devices.size() && i < aux.count; ++i) {
    const std::size_t start = aux.offset + i * sizeof(Aux);
    add(fields, devices[i] + ".digital", "-", "u32", start + offsetof(Aux, digital));
    add(fields, devices[i] + ".armed", "-", "u8", start + offsetof(Aux, armed));
    add(fields, devices[i] + ".faulted", "-", "u8", start + offsetof(Aux, faulted));
    for (std::size_t k = 0; k < std::tuple_size_v<decltype(Aux::analogue)>; ++k) {
      add(fields, devices[i] + ".analogue" + std::to_string(k), "-", "f64",
          start + offsetof(Aux, analogue) + k * sizeof(double));
    }
  }
}

std::string number(double value) {
  std::array<char, 32> text;
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

/// The header as text, config and padding included. Its own length stands in it, so it is made
/// until that fits.
std::string header_text(const RecordingHeader& header) {
  std::string head = "hapticd-recording 1\nrate_Hz " + number(header.rate_Hz) + "\nconfig_digest " +
                     (header.config_digest.empty() ? "-" : header.config_digest) +
                     "\nconfig_bytes " + std::to_string(header.config_text.size()) +
                     "\nrecord_bytes " + std::to_string(header.record_bytes) + "\n";
  for (const Field& f : header.fields) {
    head += "field " + f.name + " " + f.unit + " " + f.type + " " + std::to_string(f.offset) + "\n";
  }
  // From 0 upwards the length can only grow with its own digits, so this comes to rest.
  for (std::size_t bytes = 0;;) {
    std::string text =
        head + "header_bytes " + std::to_string(bytes) + "\nend\n" + header.config_text;
    text.resize((text.size() + 7) / 8 * 8, '\0');
    if (text.size() == bytes) return text;
    bytes = text.size();
  }
}

bool is_word(std::string_view text) {
  for (const char c : text) {
    if (static_cast<unsigned char>(c) <= ' ' || c == ',' || c == '"' || c == '\x7f') return false;
  }
  return !text.empty();
}

}  // namespace

std::size_t field_bytes(std::string_view type) noexcept {
  if (type == "f64" || type == "i64") return 8;
  if (type == "i32" || type == "u32") return 4;
  if (type == "u16") return 2;
  return type == "u8" ? 1 : 0;
}

std::string header_defect(const RecordingHeader& header) {
  if (!std::isfinite(header.rate_Hz) || header.rate_Hz <= 0)
    return "rate_Hz is not a number above zero";
  if (!header.config_digest.empty() && !is_word(header.config_digest))
    return "config_digest is not one word";
  if (header.record_bytes == 0) return "record_bytes is zero";
  std::unordered_set<std::string_view> names;
  std::size_t number = 0;
  for (const Field& f : header.fields) {
    ++number;  // a hostile name is never printed
    if (!is_word(f.name) || !is_word(f.unit)) {
      return "field " + std::to_string(number) + ": name and unit are words without comma or quote";
    }
    const std::size_t bytes = field_bytes(f.type);
    if (bytes == 0) return "field " + f.name + ": its type is none of i64 f64 i32 u32 u16 u8";
    if (bytes > header.record_bytes || f.offset > header.record_bytes - bytes) {
      return "field " + f.name + ": offset " + std::to_string(f.offset) +
             " is beyond record_bytes " + std::to_string(header.record_bytes);
    }
    if (!names.insert(f.name).second) return "field " + f.name + " is there twice";
  }
  return {};
}

RecordingHeader recording_header(const build::Program& program, std::string config_digest,
                                 std::string config_text) {
  const control::RecordLayout& layout = program.plan().record;
  const build::ProgramSpec& spec = program.spec();
  RecordingHeader header;
  header.rate_Hz = 1 / program.plan().period_s;
  header.config_digest = std::move(config_digest);
  header.config_text = std::move(config_text);
  header.record_bytes = layout.bytes;
  add_header_fields(header.fields);
  add_input_fields(header.fields, spec, layout);
  add_recorded(header.fields, spec.axis_names, layout, control::Per::axis, spec.rotary);
  add_recorded(header.fields, spec.coordinate_names, layout, control::Per::coordinate, {});
  add_recorded(header.fields, spec.device_names, layout, control::Per::device, {});
  add_aux_fields(header.fields, spec.device_names, layout.aux);
  return header;
}

RecordingWriter::RecordingWriter(OutputFile file, std::size_t header_bytes,
                                 std::size_t record_bytes)
    : file_(std::move(file)), header_bytes_(header_bytes), record_bytes_(record_bytes) {}

Result<RecordingWriter> RecordingWriter::create(const std::string& path,
                                                const RecordingHeader& header, IfExists if_exists) {
  if (std::string defect = header_defect(header); !defect.empty()) {
    return fail(ExitCode::software,
                path + ": not written, its header would be unreadable: " + defect);
  }
  auto file = OutputFile::create(path, if_exists);
  if (!file) return tl::unexpected(file.error());
  const std::string text = header_text(header);
  RecordingWriter writer(std::move(*file), text.size(), header.record_bytes);
  // Flushed at once, so that a file is readable from its first moment on.
  auto written = writer.file_.write(text);
  if (written) written = writer.file_.flush();
  if (!written) return tl::unexpected(written.error());
  return writer;
}

Result<void> RecordingWriter::append(const std::byte* record) {
  auto result = file_.write(record, record_bytes_);
  if (result) ++records_;
  return told(std::move(result));
}

Result<void> RecordingWriter::flush() {
  return told(file_.flush());
}

Result<void> RecordingWriter::close() {
  return told(file_.close());
}

Result<void> RecordingWriter::told(Result<void> result) const {
  if (result) return result;
  const std::uint64_t safe =
      file_.written() < header_bytes_ ? 0 : (file_.written() - header_bytes_) / record_bytes_;
  return fail(result.error().code, result.error().text + "; the " + std::to_string(safe) +
                                       " whole records written before are safe and readable");
}

}  // namespace hapticd::daemon
