// Tree -> structs, strictly: the visitor of config/describe.h that reads. Errors are collected,
// reading goes on.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "config/describe.h"
#include "config/error.h"
#include "config/field_traits.h"
#include "config/places.h"
#include "config/yaml_tree.h"

namespace hapticd::config {

/// What reading one file gathers.
class Reading {
 public:
  explicit Reading(std::string file) : file_(std::move(file)) {}

  void refuse(Mark mark, const std::string& path, std::string message);
  /// "expected <what>, found <the node>", with a hint after it where there is one.
  void refuse_value(const Node& node, const std::string& path, const std::string& expected,
                    const std::string& hint = {});

  Places places;
  std::vector<ConfigError> errors;

 private:
  std::string file_;
};

// One value each; a value that is refused leaves `out` alone.
void read_real(Reading& reading, const Node& node, const std::string& path, const Key& key,
               double& out);
void read_whole(Reading& reading, const Node& node, const std::string& path, const Key& key,
                std::int64_t& out);
void read_bool(Reading& reading, const Node& node, const std::string& path, bool& out);
void read_text(Reading& reading, const Node& node, const std::string& path, const Key& key,
               std::string& out);
/// The index of the word in `words`.
void read_word(Reading& reading, const Node& node, const std::string& path,
               const std::vector<std::string>& words, std::size_t& out);
/// Is it a list with as many items as the key takes? Reports if not.
bool check_list(Reading& reading, const Node& node, const std::string& path, const Key& key);

/// One map of the file against one struct.
class StructReader {
 public:
  StructReader(Reading& reading, const Node& map, std::string path)
      : reading_(reading), map_(map), path_(std::move(path)) {}

  template <class T>
  void required(const char* name, T& field, const Key& key) {
    if (!take(name, field, key)) report_missing(name, key);
  }
  template <class T>
  void optional(const char* name, T& field, const Key& key) {
    take(name, field, key);
  }
  /// Reports the keys that nobody asked for.
  void report_unknown() const;

 private:
  template <class T>
  bool take(const char* name, T& field, const Key& key);
  std::string path_of(const std::string& name) const {
    return path_.empty() ? name : path_ + "." + name;
  }
  void report_missing(const char* name, const Key& key);

  Reading& reading_;
  const Node& map_;
  std::string path_;
  std::vector<std::string> known_;
};

template <class T>
void read_value(Reading& reading, const Node& node, const std::string& path, const Key& key,
                T& out);

template <class T>
void read_struct(Reading& reading, const Node& node, const std::string& path, T& out) {
  if (node.kind != NodeKind::map) {
    reading.refuse_value(node, path, "a map of keys");
    return;
  }
  StructReader reader(reading, node, path);
  describe(reader, out);
  reader.report_unknown();
}

/// A number, a list of numbers, or a list of such lists.
void read_gains(Reading& reading, const Node& node, const std::string& path, const Key& key,
                Gains& out);

template <class E>
void read_enum(Reading& reading, const Node& node, const std::string& path, E& out) {
  auto index = static_cast<std::size_t>(out);
  read_word(reading, node, path, {Words<E>::list.begin(), Words<E>::list.end()}, index);
  out = static_cast<E>(index);
}

template <class T>
void read_items(Reading& reading, const Node& node, const std::string& path, const Key& key,
                T& out) {
  for (std::size_t i = 0; i < out.size(); ++i) {
    read_value(reading, node.items[i], path + "[" + std::to_string(i) + "]", key, out[i]);
  }
}

/// A map with one key, which names the alternative.
template <class T>
void read_variant(Reading& reading, const Node& node, const std::string& path, T& out) {
  std::vector<std::string> kinds;
  for_each_alternative<T>([&]<class A>(A) { kinds.emplace_back(kKindOf<A>); });
  if (node.kind != NodeKind::map || node.items.size() != 1) {
    reading.refuse_value(node, path, "a map with one key, the kind, such as '" + kinds[0] + "'");
    return;
  }
  Node kind{.kind = NodeKind::scalar, .mark = node.keys[0].mark, .text = node.keys[0].text};
  auto index = kinds.size();
  read_word(reading, kind, path, kinds, index);
  std::size_t at = 0;
  for_each_alternative<T>([&]<class A>(A alternative) {
    if (at++ != index) return;
    read_value(reading, node.items[0], path + "." + kKindOf<A>, Key{}, alternative);
    out = std::move(alternative);
  });
}

template <class T>
void read_value(Reading& reading, const Node& node, const std::string& path, const Key& key,
                T& out) {
  reading.places.add(path, node.mark);
  if (node.kind == NodeKind::refused) return;
  if constexpr (kIsOptional<T>) {
    out.reset();
    if (node.kind != NodeKind::null) read_value(reading, node, path, key, out.emplace());
  } else if constexpr (kIsReal<T>) {
    read_real(reading, node, path, key, out);
  } else if constexpr (kIsWhole<T>) {
    auto whole = static_cast<std::int64_t>(out);
    read_whole(reading, node, path, key, whole);
    out = static_cast<T>(whole);  // in range: that of the key lies within the type's
  } else if constexpr (kIsBool<T>) {
    read_bool(reading, node, path, out);
  } else if constexpr (kIsText<T>) {
    read_text(reading, node, path, key, out);
  } else if constexpr (std::is_enum_v<T>) {
    read_enum(reading, node, path, out);
  } else if constexpr (kIsVector<T>) {
    if (!check_list(reading, node, path, key)) return;
    out.assign(node.items.size(), {});
    read_items(reading, node, path, key, out);
  } else if constexpr (kIsArray<T>) {
    Key fixed = key;
    fixed.min_items = fixed.max_items = out.size();
    if (check_list(reading, node, path, fixed)) read_items(reading, node, path, key, out);
  } else if constexpr (kIsGains<T>) {
    read_gains(reading, node, path, key, out);
  } else if constexpr (kIsVariant<T>) {
    read_variant(reading, node, path, out);
  } else {
    read_struct(reading, node, path, out);
  }
}

template <class T>
bool StructReader::take(const char* name, T& field, const Key& key) {
  known_.emplace_back(name);
  const Node* value = find(map_, name);
  if (value != nullptr) read_value(reading_, *value, path_of(name), key, field);
  return value != nullptr;
}

}  // namespace hapticd::config
