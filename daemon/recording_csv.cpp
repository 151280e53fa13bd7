#include <array>
#include <charconv>
#include <cmath>
#include <cstring>

#include "daemon/recording.h"

namespace hapticd::daemon {
namespace {

using Text = std::array<char, 40>;  // 17 digits, sign, point and exponent of a double; 20
                                    // characters of an i64

template <class T>
std::string_view printed(const std::byte* at, Text& text) {
  T value;
  std::memcpy(&value, at, sizeof value);
  char* const end = text.data() + text.size();
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(value)) return "nan";  // its sign and payload mean nothing
    return {text.data(),
            std::to_chars(text.data(), end, value, std::chars_format::general, 17).ptr};
  } else {
    return {text.data(), std::to_chars(text.data(), end, value).ptr};
  }
}

/// One column: where its values stand and how they are printed.
struct Column {
  std::uint32_t offset;
  std::string_view (*print)(const std::byte*, Text&);
};

Column column(const Field& field) {
  if (field.type == "f64") return {field.offset, printed<double>};
  if (field.type == "i64") return {field.offset, printed<std::int64_t>};
  if (field.type == "i32") return {field.offset, printed<std::int32_t>};
  if (field.type == "u32") return {field.offset, printed<std::uint32_t>};
  if (field.type == "u16") return {field.offset, printed<std::uint16_t>};
  return {field.offset, printed<std::uint8_t>};
}

std::string title_line(const std::vector<Field>& fields) {
  std::string line;
  for (const Field& field : fields) {
    if (!line.empty()) line += ',';
    line += field.name;
    if (field.unit != "-") line += '[' + field.unit + ']';
  }
  return line + '\n';
}

}  // namespace

Result<void> write_csv(const Recording& recording, const std::string& path) {
  auto file = OutputFile::create(path, IfExists::replace);
  if (!file) return tl::unexpected(file.error());
  std::vector<Column> columns;
  for (const Field& field : recording.header.fields) columns.push_back(column(field));
  std::string line = title_line(recording.header.fields);
  auto written = file->write(line);
  Text text;
  for (std::size_t i = 0; i < recording.size() && written; ++i) {
    const std::byte* record = recording.data.data() + i * recording.header.record_bytes;
    line.clear();
    for (const Column& c : columns) {
      if (!line.empty()) line += ',';
      line += c.print(record + c.offset, text);
    }
    line += '\n';
    written = file->write(line);
  }
  if (!written) return written;
  return file->close();
}

}  // namespace hapticd::daemon
