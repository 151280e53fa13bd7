#include "config/json_schema.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>

#include "config/describe.h"
#include "config/field_traits.h"
#include "config/limits_text.h"
#include "config/text_form.h"

namespace hapticd::config {
namespace {

using Json = nlohmann::ordered_json;

/// 1000 rather than 1000.0, as people write it.
Json plain_number(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

template <class T>
Json schema_of(const Key& key);
template <class T>
Json default_of(const T& value);

/// Describes the keys of one struct.
class SchemaWriter {
 public:
  template <class T>
  void required(const char* name, T&, const Key& key) {
    add<T>(name, key);
    required_.push_back(name);
  }
  template <class T>
  void optional(const char* name, T& field, const Key& key) {
    add<T>(name, key)["default"] = default_of(field);
  }
  Json finish() {
    Json schema = {{"type", "object"}, {"additionalProperties", false}};
    if (!required_.empty()) schema["required"] = std::move(required_);
    schema["properties"] = std::move(properties_);
    return schema;
  }

 private:
  template <class T>
  Json& add(const char* name, const Key& key) {
    Json schema = {{"description", key.about}};
    schema.update(schema_of<T>(key));
    return properties_[name] = std::move(schema);
  }

  Json properties_ = Json::object();
  Json required_ = Json::array();
};

/// The defaults of a struct as a map of its optional keys.
class DefaultWriter {
 public:
  template <class T>
  void required(const char*, T&, const Key&) {}
  template <class T>
  void optional(const char* name, T& field, const Key&) {
    values[name] = default_of(field);
  }
  Json values = Json::object();
};

template <class T>
Json number_schema(const Key& key, const char* type) {
  Json schema = {{"type", type}};
  if (std::isfinite(key.min))
    schema[key.above_min ? "exclusiveMinimum" : "minimum"] = plain_number(key.min);
  if (std::isfinite(key.max)) schema["maximum"] = plain_number(key.max);
  if (const std::string unit = key.unit; !unit.empty()) schema["x-unit"] = unit;
  return schema;
}

template <class T>
Json list_schema(const Key& key, std::size_t min_items, std::size_t max_items) {
  Json schema = {{"type", "array"}, {"items", schema_of<T>(key)}};
  if (min_items > 0) schema["minItems"] = min_items;
  if (max_items != Key{}.max_items) schema["maxItems"] = max_items;
  return schema;
}

template <class T>
Json nullable_schema(const Key& key) {
  Json schema = schema_of<T>(key);
  if (!schema["type"].is_array()) schema["type"] = Json::array({schema["type"]});
  schema["type"].push_back("null");
  return schema;
}

/// A number, a list or a matrix: what is said of each type holds where the value is of that type.
Json gains_schema(const Key& key) {
  Json row = list_schema<double>(key, key.min_items, key.max_items);
  Json schema = number_schema<double>(key, "number");
  schema["type"] = Json::array({"number", "array"});
  Json item = schema;
  item.update(
      Json{{"items", row["items"]}, {"minItems", key.min_items}, {"maxItems", key.max_items}});
  schema.update(
      Json{{"items", std::move(item)}, {"minItems", key.min_items}, {"maxItems", key.max_items}});
  return schema;
}

template <class T>
Json variant_schema() {
  Json properties = Json::object();
  for_each_alternative<T>([&]<class A>(A) { properties[kKindOf<A>] = schema_of<A>(Key{}); });
  return {{"type", "object"},
          {"minProperties", 1},
          {"maxProperties", 1},
          {"additionalProperties", false},
          {"properties", properties}};
}

template <class T>
Json struct_schema() {
  SchemaWriter writer;
  T defaults{};
  describe(writer, defaults);
  return writer.finish();
}

template <class T>
Json schema_of(const Key& key) {
  if constexpr (kIsOptional<T>) {
    return nullable_schema<typename T::value_type>(key);
  } else if constexpr (kIsReal<T>) {
    return number_schema<T>(key, "number");
  } else if constexpr (kIsWhole<T>) {
    return number_schema<T>(key, "integer");
  } else if constexpr (kIsBool<T>) {
    return {{"type", "boolean"}};
  } else if constexpr (kIsText<T>) {
    Json schema = {{"type", "string"}};
    if (const char* pattern = pattern_of(key.form)) schema["pattern"] = pattern;
    return schema;
  } else if constexpr (std::is_enum_v<T>) {
    return {{"type", "string"}, {"enum", Words<T>::list}};
  } else if constexpr (kIsVector<T>) {
    return list_schema<typename T::value_type>(key, key.min_items, key.max_items);
  } else if constexpr (kIsArray<T>) {
    return list_schema<typename T::value_type>(key, T{}.size(), T{}.size());
  } else if constexpr (kIsGains<T>) {
    return gains_schema(key);
  } else if constexpr (kIsVariant<T>) {
    return variant_schema<T>();
  } else {
    return struct_schema<T>();
  }
}

template <class T>
Json default_of(const T& value) {
  if constexpr (kIsOptional<T>) {
    return value ? default_of(*value) : Json(nullptr);
  } else if constexpr (kIsReal<T>) {
    return plain_number(value);
  } else if constexpr (std::is_enum_v<T>) {
    return word_of(value);
  } else if constexpr (kIsVector<T> || kIsArray<T>) {
    Json list = Json::array();
    if constexpr (!kIsVariant<typename T::value_type>) {  // objects have names, so no default has
                                                          // any
      for (const auto& item : value) list.push_back(default_of(item));
    }
    return list;
  } else if constexpr (kIsGains<T>) {
    return std::visit([](const auto& form) { return default_of(form); }, value.value);
  } else if constexpr (kIsStruct<T>) {
    DefaultWriter writer;
    T defaults = value;
    describe(writer, defaults);
    return writer.values;
  } else {
    return value;
  }
}

}  // namespace

std::string json_schema() {
  Json schema = {
      {"$schema", "https://json-schema.org/draft/2020-12/schema"},
      {"title", "hapticd config"},
      {"description", "Generated from config/describe.h by hapticd_config_schema; do not edit."}};
  schema.update(schema_of<Config>(Key{}));
  return schema.dump(2) + "\n";
}

}  // namespace hapticd::config
