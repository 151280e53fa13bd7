#include "config/reader.h"

#include <algorithm>

#include "config/limits_text.h"
#include "config/nearest.h"
#include "config/number.h"
#include "config/text_check.h"
#include "config/text_form.h"

namespace hapticd::config {
namespace {

/// A node as a person sees it in the file.
std::string shown(const Node& node) {
  switch (node.kind) {
    case NodeKind::null:
      return "nothing";
    case NodeKind::sequence:
      return "a list of " + std::to_string(node.items.size());
    case NodeKind::map:
      return node.items.empty() ? "an empty map" : "a map";
    case NodeKind::scalar:
      return node.quoted ? "the text " + quote(node.text) : quote(node.text);
    case NodeKind::refused:
      break;
  }
  return "something refused";
}

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

bool is_plain(const Node& node) {
  return node.kind == NodeKind::scalar && !node.quoted;
}

/// "a number from 0 to 1 N"
std::string expected_number(const char* what, const Key& key) {
  const std::string range = range_text(key);
  return range.empty() ? what : what + (" " + range);
}

std::string quoted_number_hint(const Node& node) {
  return node.kind == NodeKind::scalar && node.quoted && looks_like_number(node.text)
             ? "remove the quotes"
             : "";
}

/// Reads a number of one type with its parser, and holds it against the range.
template <class T, class Parse>
void read_number(Reading& reading, const Node& node, const std::string& path, const Key& key,
                 const char* what, Parse parse, T& out) {
  const std::string expected = expected_number(what, key);
  if (!is_plain(node)) {
    reading.refuse_value(node, path, expected, quoted_number_hint(node));
    return;
  }
  const auto value = parse(node.text);
  if (!value) {
    reading.refuse_value(node, path, expected, value.error());
  } else if (!in_range(static_cast<double>(*value), key)) {
    reading.refuse_value(node, path, expected);
  } else {
    out = *value;
  }
}

}  // namespace

void Reading::refuse(Mark mark, const std::string& path, std::string message) {
  if (errors.size() >= kMaxErrors) return;
  errors.push_back({.file = file_,
                    .line = mark.line,
                    .column = mark.column,
                    .path = path,
                    .message = std::move(message)});
}

void Reading::refuse_value(const Node& node, const std::string& path, const std::string& expected,
                           const std::string& hint) {
  std::string message = "expected " + expected + ", found " + shown(node);
  if (!hint.empty()) message += "; " + hint;
  refuse(node.mark, path, std::move(message));
}

void read_real(Reading& reading, const Node& node, const std::string& path, const Key& key,
               double& out) {
  read_number(reading, node, path, key, "a number", parse_real, out);
}

void read_whole(Reading& reading, const Node& node, const std::string& path, const Key& key,
                std::int64_t& out) {
  read_number(reading, node, path, key, "a whole number", parse_whole, out);
}

void read_bool(Reading& reading, const Node& node, const std::string& path, bool& out) {
  const bool is_true = is_plain(node) && node.text == "true";
  if (!is_true && !(is_plain(node) && node.text == "false")) {
    reading.refuse_value(node, path, "true or false, written like this");
    return;
  }
  out = is_true;
}

void read_text(Reading& reading, const Node& node, const std::string& path, const Key& key,
               std::string& out) {
  const bool other_type = is_plain(node) && (looks_like_number(node.text) || node.text == "true" ||
                                             node.text == "false");
  if (node.kind != NodeKind::scalar || other_type) {
    reading.refuse_value(node, path, expected_text(key.form),
                         other_type && key.form == TextForm::any ? "put it in quotes" : "");
  } else if (!has_form(node.text, key.form)) {
    reading.refuse_value(node, path, expected_text(key.form));
  } else {
    out = node.text;
  }
}

void read_word(Reading& reading, const Node& node, const std::string& path,
               const std::vector<std::string>& words, std::size_t& out) {
  const auto found = std::find(words.begin(), words.end(), node.text);
  if (node.kind == NodeKind::scalar && found != words.end()) {
    out = static_cast<std::size_t>(found - words.begin());
    return;
  }
  const std::string near = node.kind == NodeKind::scalar ? nearest(node.text, words) : "";
  reading.refuse_value(node, path, (words.size() > 1 ? "one of " : "") + joined(words),
                       near.empty() || words.size() == 1 ? "" : "did you mean '" + near + "'?");
}

bool check_list(Reading& reading, const Node& node, const std::string& path, const Key& key) {
  const std::size_t count = node.items.size();
  if (node.kind == NodeKind::sequence && count >= key.min_items && count <= key.max_items)
    return true;
  std::string entries = count_text(key);
  if (key.min_items == key.max_items) entries = std::to_string(key.min_items) + " entries";
  reading.refuse_value(node, path, entries.empty() ? "a list" : "a list of " + entries);
  return false;
}

void read_gains(Reading& reading, const Node& node, const std::string& path, const Key& key,
                Gains& out) {
  if (node.kind == NodeKind::sequence) {
    const bool by_rows = !node.items.empty() && node.items[0].kind == NodeKind::sequence;
    by_rows ? read_value(reading, node, path, key, out.value.emplace<Rows>())
            : read_value(reading, node, path, key, out.value.emplace<std::vector<double>>());
  } else if (is_plain(node)) {
    read_real(reading, node, path, key, out.value.emplace<double>());
  } else {
    reading.refuse_value(node, path,
                         expected_number("a number", key) + ", a list of them, or a matrix",
                         quoted_number_hint(node));
  }
}

void StructReader::report_missing(const char* name, const Key& key) {
  reading_.refuse(map_.mark, path_of(name),
                  "missing; expected here: " + std::string(name) + ", " + key.about);
}

void StructReader::report_unknown() const {
  for (const YamlKey& key : map_.keys) {
    if (std::find(known_.begin(), known_.end(), key.text) != known_.end()) continue;
    const std::string near = nearest(key.text, known_);
    reading_.refuse(key.mark, path_of(quote(key.text)),
                    near.empty() ? "unknown key; known here: " + joined(known_)
                                 : "unknown key; did you mean '" + near + "'?");
  }
}

}  // namespace hapticd::config
