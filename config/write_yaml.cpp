#include "config/write_yaml.h"

#include <variant>

#include "config/describe.h"
#include "config/field_traits.h"
#include "config/number.h"
#include "config/text_check.h"

namespace hapticd::config {
namespace {

/// Numbers, words, texts and lists of them: what stands on one line.
template <class T>
inline constexpr bool kIsPlain =
    kIsReal<T> || kIsWhole<T> || kIsBool<T> || kIsText<T> || std::is_enum_v<T>;
template <class T>
inline constexpr bool kIsPlainList = false;
template <class T>
inline constexpr bool kIsPlainList<std::vector<T>> = kIsPlain<T>;
template <class T, std::size_t N>
inline constexpr bool kIsPlainList<std::array<T, N>> = kIsPlain<T>;

/// In double quotes, as YAML and JSON have it.
std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + "\"";
}

template <class T>
std::string plain(const T& value) {
  if constexpr (kIsReal<T>) {
    return format_exact(value);
  } else if constexpr (kIsWhole<T>) {
    return std::to_string(value);
  } else if constexpr (kIsBool<T>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_enum_v<T>) {
    return std::string(word_of(value));
  } else {
    return quoted(value);
  }
}

template <class List>
std::string flow(const List& list) {
  std::string text;
  for (const auto& item : list) text += (text.empty() ? "" : ", ") + plain(item);
  return "[" + text + "]";
}

/// A value as it stands behind its key: on the same line, or in lines of its own below.
template <class T>
std::string after_key(const T& value, const std::string& indent);

/// The keys of a struct, a line each; the visitor of config/describe.h.
class YamlKeys {
 public:
  explicit YamlKeys(std::string indent) : indent_(std::move(indent)) {}

  template <class T>
  void required(const char* name, T& field, const Key&) {
    text += indent_ + name + ":" + after_key(field, indent_ + "  ");
  }
  template <class T>
  void optional(const char* name, T& field, const Key& key) {
    if constexpr (kIsOptional<T>) {
      if (field) required(name, *field, key);
    } else if constexpr (kIsVector<T>) {
      if (!field.empty()) required(name, field, key);
    } else {
      required(name, field, key);
    }
  }
  std::string text;

 private:
  std::string indent_;
};

template <class T>
std::string keys_of(const T& value, const std::string& indent) {
  YamlKeys writer(indent);
  T copy = value;
  describe(writer, copy);
  return writer.text;
}

/// A list of what needs lines of its own. The first key of an item stands behind its dash.
template <class List>
std::string block(const List& list, const std::string& indent) {
  std::string text;
  for (const auto& item : list) {
    using Item = std::decay_t<decltype(item)>;
    if constexpr (kIsStruct<Item>) {
      text += indent + "- " + keys_of(item, indent + "  ").substr(indent.size() + 2);
    } else if constexpr (kIsVariant<Item>) {
      const auto kind = [&]<class A>(const A& alternative) {
        return std::string(kKindOf<A>) + ":\n" + keys_of(alternative, indent + "    ");
      };
      text += indent + "- " + std::visit(kind, item);
    } else {
      text += indent + "-" + after_key(item, indent + "  ");
    }
  }
  return text;
}

template <class T>
std::string after_key(const T& value, const std::string& indent) {
  if constexpr (kIsOptional<T>) {
    return value ? after_key(*value, indent) : " null\n";
  } else if constexpr (kIsPlain<T>) {
    return " " + plain(value) + "\n";
  } else if constexpr (kIsPlainList<T>) {
    return " " + flow(value) + "\n";
  } else if constexpr (kIsGains<T>) {
    return std::visit([&](const auto& form) { return after_key(form, indent); }, value.value);
  } else if constexpr (kIsVector<T> || kIsArray<T>) {
    return value.empty() ? " []\n" : "\n" + block(value, indent);
  } else if constexpr (kIsVariant<T>) {
    const auto kind = [&]<class A>(const A& alternative) {
      return "\n" + indent + kKindOf<A> + ":" + after_key(alternative, indent + "  ");
    };
    return std::visit(kind, value);
  } else {
    const std::string keys = keys_of(value, indent);
    return keys.empty() ? " {}\n" : "\n" + keys;
  }
}

}  // namespace

std::string to_yaml(const CouplingFile& file) {
  return keys_of(file, "");
}
std::string to_yaml(const ModelFile& file) {
  return keys_of(file, "");
}
std::string to_yaml(const ProofFile& file) {
  return keys_of(file, "");
}
std::string to_yaml(const Config& config) {
  return keys_of(config, "");
}
std::string to_yaml(const std::vector<SceneObject>& scene) {
  return block(scene, "");
}

}  // namespace hapticd::config
