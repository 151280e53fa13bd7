// Any described struct in words: the visitor of config/describe.h that prints.
//   normal [1, 0, 0], offset 0 m, stiffness 1000 N/m, friction (static 0.5, dynamic 0.3)
#pragma once
#include <algorithm>
#include <string>
#include <string_view>
#include <variant>

#include "config/describe.h"
#include "config/field_traits.h"
#include "config/number.h"

namespace hapticd::config {

/// stiffness_N_m with the unit N/m: "stiffness".
std::string name_without_unit(std::string_view key, std::string_view unit);

template <class T>
std::string value_text(const T& value);

class TextValues {
 public:
  /// `left_out`: a key that is said elsewhere.
  explicit TextValues(std::string_view left_out = {}) : left_out_(left_out) {}

  template <class T>
  void required(const char* key, T& field, const Key& about) {
    add(key, field, about);
  }
  /// What is not there is not said.
  template <class T>
  void optional(const char* key, T& field, const Key& about) {
    add(key, field, about);
  }
  std::string text;

 private:
  template <class T>
  void add(const char* key, const T& field, const Key& about);
  template <class T>
  void append(const char* key, const T& field, const Key& about) {
    const std::string unit = about.unit;
    text += (text.empty() ? "" : ", ") + name_without_unit(key, unit) + " " + value_text(field) +
            (unit.empty() ? "" : " " + unit);
  }

  std::string_view left_out_;
};

template <class T>
void TextValues::add(const char* key, const T& field, const Key& about) {
  if constexpr (kIsOptional<T>) {
    if (field) add(key, *field, about);
  } else if constexpr (kIsVector<T>) {
    if (!field.empty()) append(key, field, about);
  } else if constexpr (kIsBool<T>) {
    if (field) text += (text.empty() ? "" : ", ") + std::string(key);
  } else if constexpr (kIsText<T>) {
    if (key != left_out_) append(key, field, about);
  } else {
    append(key, field, about);
  }
}

/// Most entries of a list that are written out.
inline constexpr std::size_t kShownEntries = 6;

template <class List>
std::string list_text(const List& list) {
  if (list.size() > kShownEntries) return std::to_string(list.size()) + " entries";
  std::string all;
  for (const auto& item : list) all += (all.empty() ? "" : ", ") + value_text(item);
  return "[" + all + "]";
}

template <class T>
std::string value_text(const T& value) {
  if constexpr (kIsText<T>) {
    return value;
  } else if constexpr (kIsBool<T>) {
    return value ? "true" : "false";
  } else if constexpr (kIsReal<T> || kIsWhole<T>) {
    return format_number(static_cast<double>(value));
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(word_of(value));
  } else if constexpr (kIsGains<T>) {
    return std::visit([](const auto& form) { return value_text(form); }, value.value);
  } else if constexpr (kIsVector<T> || kIsArray<T>) {
    return list_text(value);
  } else {
    TextValues values;
    T copy = value;
    describe(values, copy);
    return "(" + values.text + ")";
  }
}

}  // namespace hapticd::config
