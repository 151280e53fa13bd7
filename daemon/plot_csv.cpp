#include "daemon/plot_csv.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>

#include "daemon/output_file.h"

namespace hapticd::daemon {
namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

struct Column {
  std::string name{}, unit{};        ///< unit: "" for none
  std::vector<double> values{};      ///< kGap where a field is no number
  std::vector<std::string> words{};  ///< as written
  bool numbers = true;               ///< every field is a number or empty
};

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// Fields of a line; "a, ""b""" is one field.
std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"') {
      if (quoted && i + 1 < line.size() && line[i + 1] == '"')
        fields.back() += line[++i];
      else
        quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

std::optional<double> number(std::string_view text) {
  if (text.empty()) return kGap;
  if (text.front() == '+') text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::result_out_of_range) return kGap;
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Column titled(const std::string& field) {
  const std::size_t open = field.find('[');
  if (open == std::string::npos || !field.ends_with(']')) return {.name = field};
  return {.name = std::string(trimmed(std::string_view(field).substr(0, open))),
          .unit = field.substr(open + 1, field.size() - open - 2)};
}

std::string titled(const Column& column) {
  return column.unit.empty() ? column.name : column.name + " [" + column.unit + "]";
}

void append(Column& column, std::string field) {
  const auto value = number(field);
  column.numbers = column.numbers && value.has_value();
  column.values.push_back(value.value_or(kGap));
  column.words.push_back(std::move(field));
}

Result<std::vector<Column>> read_table(std::string_view text, const std::string& path) {
  const auto refuse = [&](std::size_t line, const std::string& what) {
    return fail(ExitCode::bad_data, path + " is neither a hapticd recording nor CSV: line " +
                                        std::to_string(line) + ": " + what);
  };
  std::vector<Column> table;
  std::size_t line_number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = trimmed(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    ++line_number;
    if (line.find('\0') != std::string_view::npos) return refuse(line_number, "is not text");
    if (line.empty() || line.front() == '#') continue;
    std::vector<std::string> fields = split(line);
    if (table.empty()) {
      for (const std::string& field : fields) table.push_back(titled(field));
      if (table.size() < 2)
        return refuse(line_number, "expected the names of two columns or more, with commas");
      continue;
    }
    if (fields.size() != table.size()) {
      return refuse(line_number, "expected " + std::to_string(table.size()) + " fields, found " +
                                     std::to_string(fields.size()));
    }
    for (std::size_t i = 0; i < fields.size(); ++i) append(table[i], std::move(fields[i]));
  }
  if (table.empty() || table.front().values.empty())
    return refuse(line_number, "expected a line of names and lines of numbers");
  if (!table.front().numbers)
    return refuse(line_number,
                  "expected numbers in the first column, '" + table.front().name + "': it is x");
  return table;
}

/// The first column of words.
const Column* labels_of(const std::vector<Column>& table) {
  const auto found = std::find_if(table.begin(), table.end(),
                                  [](const Column& column) { return !column.numbers; });
  return found == table.end() ? nullptr : &*found;
}

Curve curve(const std::vector<Column>& table, const Column& column, const PlotOptions& options) {
  const Column* labels = options.scatter ? labels_of(table) : nullptr;
  Curve made{.title = column.name};
  const std::vector<double>& x = table.front().values;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] >= options.from && x[i] <= options.to)) continue;
    made.x.push_back(x[i]);
    made.y.push_back(column.values[i]);
    if (labels != nullptr) made.labels.push_back(labels->words[i]);
  }
  return made;
}

std::vector<Panel> panels_by_unit(const std::vector<Column>& table, const PlotOptions& options) {
  std::vector<Panel> panels;
  std::vector<std::string> units;
  for (std::size_t i = 1; i < table.size(); ++i) {
    const Column& column = table[i];
    if (!column.numbers) continue;
    const auto known = std::find(units.begin(), units.end(), column.unit);
    if (known == units.end()) {
      panels.push_back({.label = titled(column), .curves = {curve(table, column, options)}});
      units.push_back(column.unit);
    } else {
      Panel& panel = panels[static_cast<std::size_t>(known - units.begin())];
      panel.label = column.unit.empty() ? "" : "[" + column.unit + "]";
      panel.curves.push_back(curve(table, column, options));
    }
  }
  return panels;
}

Result<std::vector<Panel>> named_panels(const std::vector<Column>& table, const std::string& path,
                                        const PlotOptions& options) {
  std::vector<Panel> panels;
  for (const std::string& name : options.fields) {
    const auto column = std::find_if(table.begin() + 1, table.end(), [&](const Column& c) {
      return c.numbers && (c.name == name || c.name + "[" + c.unit + "]" == name);
    });
    if (column == table.end()) {
      std::string text = path + " has no column of numbers '" + name + "' beside x; there are:";
      for (auto c = table.begin() + 1; c != table.end(); ++c)
        text += c->numbers ? " " + c->name : "";
      return fail(ExitCode::usage, text);
    }
    panels.push_back({.label = titled(*column), .curves = {curve(table, *column, options)}});
  }
  return panels;
}

}  // namespace

Result<Picture> csv_picture(std::string_view text, const std::string& path,
                            const PlotOptions& options) {
  const auto table = read_table(text, path);
  if (!table) return tl::unexpected(table.error());
  Picture picture{.title = std::filesystem::path(path).filename().string(),
                  .x_label = titled(table->front())};
  if (options.fields.empty()) {
    picture.panels = panels_by_unit(*table, options);
    return picture;
  }
  auto panels = named_panels(*table, path, options);
  if (!panels) return tl::unexpected(panels.error());
  picture.panels = std::move(*panels);
  return picture;
}

Result<Picture> csv_picture(const std::string& path, const PlotOptions& options) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file.is_open() || file.bad() || (text.str().empty() && errno != 0)) {
    const int reason = errno == 0 ? EIO : errno;
    const bool denied = reason == EACCES || reason == EPERM;
    return fail(denied ? ExitCode::no_permission : ExitCode::no_input,
                path + ": cannot be read: " + errno_text(reason));
  }
  return csv_picture(text.str(), path, options);
}

}  // namespace hapticd::daemon
