#include "config/man_keys.h"

#include <array>
#include <type_traits>
#include <variant>
#include <vector>

#include "config/describe.h"
#include "config/field_traits.h"
#include "config/limits_text.h"
#include "config/number.h"

namespace hapticd::config {
namespace {

/// scdoc reads *, _, \, # and others as marks.
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '_' || c == '*' || c == '\\' || c == '[' || c == '#') out += '\\';
    out += c;
  }
  return out;
}

template <class T>
std::string words_of() {
  std::string text;
  for (const std::string_view word : Words<T>::list)
    text += (text.empty() ? "" : " | ") + std::string(word);
  return text;
}

std::string with_detail(const std::string& what, const std::string& detail) {
  return detail.empty() ? what : what + " " + detail;
}

/// What a key takes: "number from 10 to 20000 Hz".
template <class T>
std::string type_text(const Key& key) {
  if constexpr (kIsOptional<T>) {
    return type_text<typename T::value_type>(key) + ", or null";
  } else if constexpr (kIsReal<T>) {
    return with_detail("number", range_text(key));
  } else if constexpr (kIsWhole<T>) {
    return with_detail("whole number", range_text(key));
  } else if constexpr (kIsBool<T>) {
    return "true | false";
  } else if constexpr (kIsText<T>) {
    constexpr std::array forms{"text",
                               "name",
                               "name, or name with direction",
                               "text such as 1209:ffb0",
                               "text such as 1-2.3",
                               "64 hexadecimal digits"};
    return forms[static_cast<std::size_t>(key.form)];
  } else if constexpr (std::is_enum_v<T>) {
    return words_of<T>();
  } else if constexpr (kIsGains<T>) {
    return with_detail("number, list or matrix", range_text(key));
  } else if constexpr (kIsVector<T>) {
    return with_detail("list of", count_text(key)) +
           ", each: " + type_text<typename T::value_type>(key);
  } else if constexpr (kIsArray<T>) {
    return "list of " + std::to_string(T{}.size()) +
           ", each: " + type_text<typename T::value_type>(key);
  } else {
    return "map";
  }
}

template <class T>
std::string default_text(const T& value) {
  if constexpr (kIsOptional<T>) {
    return value ? default_text(*value) : "null";
  } else if constexpr (kIsReal<T> || kIsWhole<T>) {
    return format_exact(static_cast<double>(value));
  } else if constexpr (kIsBool<T>) {
    return value ? "true" : "false";
  } else if constexpr (kIsText<T>) {
    return value;
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(word_of(value));
  } else if constexpr (kIsGains<T>) {
    return default_text(std::get<double>(value.value));
  } else if constexpr (kIsVector<T>) {
    return "empty";
  } else if constexpr (kIsArray<T>) {
    std::string text;
    for (const auto& item : value) text += (text.empty() ? "" : ", ") + default_text(item);
    return text;
  } else {
    return "as its keys say";
  }
}

/// One section per map, the maps within it after it.
class ManWriter {
 public:
  explicit ManWriter(std::string path) : path_(std::move(path)) {}

  template <class T>
  void required(const char* name, T&, const Key& key) {
    add_entry<T>(name, key, "required");
    add_sections<T>(path_.empty() ? name : path_ + "." + name);
  }
  template <class T>
  void optional(const char* name, T& field, const Key& key) {
    add_entry<T>(name, key, "default " + default_text(field));
    add_sections<T>(path_.empty() ? name : path_ + "." + name);
  }
  std::string finish() const {
    // scdoc takes headings as they are.
    return "## " + (path_.empty() ? "The file" : path_) + "\n\n" + entries_ + sections_;
  }

 private:
  template <class T>
  void add_entry(const char* name, const Key& key, const std::string& presence) {
    entries_ += "*" + escaped(name) + "*: " + escaped(type_text<T>(key)) + "; " +
                escaped(presence) + "\n\t" + escaped(key.about) + "\n\n";
  }
  /// Goes down into maps, through lists and kinds.
  template <class T>
  void add_sections(const std::string& path) {
    if constexpr (kIsOptional<T>) {
      add_sections<typename T::value_type>(path);
    } else if constexpr (kIsVector<T>) {
      add_sections<typename T::value_type>(path + "[]");
    } else if constexpr (kIsVariant<T>) {
      for_each_alternative<T>([&]<class A>(A) { add_sections<A>(path + "." + kKindOf<A>); });
    } else if constexpr (kIsStruct<T>) {
      ManWriter writer(path);
      T defaults{};
      describe(writer, defaults);
      sections_ += writer.finish();
    }
  }

  std::string path_;
  std::string entries_;
  std::string sections_;
};

}  // namespace

std::string man_keys() {
  ManWriter writer("");
  Config defaults;
  describe(writer, defaults);
  ManWriter file("coupling file");
  CouplingFile designed;
  describe_designed(file, designed);
  return writer.finish() + file.finish();
}

}  // namespace hapticd::config
