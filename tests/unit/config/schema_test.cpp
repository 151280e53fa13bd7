// The JSON schema and the man page are up to date, and what the schema says is what the reader
// does.
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "config/json_schema.h"
#include "config/man_keys.h"
#include "tests/unit/config/full_config.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

/// One key of the schema, and where it stands in a config that has it.
struct Place {
  json schema;
  json::json_pointer where;
  json config;  ///< kFull, with another kind where the key belongs to that
  bool required = false;
  bool is_kind = false;  ///< the one key of a map that names a kind
};

bool is_nullable(const json& schema) {
  return schema["type"].is_array() && schema["type"].back() == "null";
}

/// A number, or a list or matrix of them.
bool is_gains(const json& schema) {
  return schema["type"].is_array() && schema["type"].size() > 1 && schema["type"][1] == "array";
}

std::string type_of(const json& schema) {
  return schema["type"].is_array() ? schema["type"][0].get<std::string>()
                                   : schema["type"].get<std::string>();
}

/// `config` with the kind `key` at `where`.
json with_kind(json config, const json::json_pointer& where, const std::string& key) {
  if (!config[where].contains(key)) config[where] = json{{key, other_kind(key)}};
  return config;
}

void gather(const json& schema, const json::json_pointer& where, const json& config,
            std::vector<Place>& places) {
  const std::string type = type_of(schema);
  if (type == "array") gather(schema["items"], where / 0, config, places);
  if (type != "object") return;
  const bool kinds = schema.contains("maxProperties");
  const auto required = schema.value("required", std::vector<std::string>{});
  for (const auto& [key, sub] : schema["properties"].items()) {
    const bool is_required = std::find(required.begin(), required.end(), key) != required.end();
    const json own = kinds ? with_kind(config, where, key) : config;
    places.push_back({sub, where / key, own, is_required, kinds});
    gather(sub, where / key, own, places);
  }
}

std::vector<Place> all_places() {
  std::vector<Place> places;
  gather(json::parse(json_schema()), json::json_pointer(), kFull, places);
  return places;
}

/// Under a sanitizer all of them take minutes, and most are read by the same code.
#ifdef HAPTICD_SANITIZED
constexpr int kOneIn = 5;
#else
constexpr int kOneIn = 1;
#endif

std::vector<Place> sampled_places() {
  std::vector<Place> places = all_places();
  std::size_t next = 0;
  std::erase_if(places, [&](const Place&) { return next++ % kOneIn != 0; });
  return places;
}

bool accepts(const json& config) {
  return read_text(config.dump(), "j").has_value();
}

json with(const Place& place, const json& value) {
  json config = place.config;
  config[place.where] = value;
  return config;
}

json without(const Place& place) {
  json config = place.config;
  config[place.where.parent_pointer()].erase(place.where.back());
  return config;
}

TEST(Schema, CommittedFileIsUpToDate) {
  EXPECT_EQ(file_text(source_path("config/hapticd.schema.json")), json_schema())
      << "run hapticd_config_schema > config/hapticd.schema.json";
}

TEST(Schema, ManPageIsUpToDate) {
  const std::string page = file_text(source_path("systemd/hapticd.yaml.5.scd"));
  const auto begin = page.find(kManBegin);
  const auto end = page.find(kManEnd);
  ASSERT_NE(begin, std::string::npos);
  ASSERT_NE(end, std::string::npos);
  const auto start = begin + std::string(kManBegin).size();
  EXPECT_EQ(page.substr(start, end - start), man_keys())
      << "paste hapticd_config_schema --man between the marks";
}

TEST(Schema, ManPageHasEveryKey) {
  const std::string page = man_keys();
  for (const Place& place : all_places()) {
    if (place.is_kind) continue;
    std::string key = place.where.back();
    for (std::size_t at = 0; (at = key.find('_', at)) != std::string::npos; at += 2)
      key.insert(at, "\\");
    EXPECT_NE(page.find("*" + key + "*: "), std::string::npos) << key;
  }
}

TEST(Schema, FullConfigHasEveryKeyAndIsAccepted) {
  ASSERT_TRUE(accepts(kFull)) << listed(read_text(kFull.dump(), "j").error());
  const auto places = all_places();
  EXPECT_GT(places.size(), 200U);
  for (const Place& place : places) EXPECT_TRUE(place.config.contains(place.where)) << place.where;
}

TEST(Schema, RequiredIsWhatTheReaderRequires) {
  for (const Place& place : sampled_places()) {
    if (place.is_kind) continue;
    EXPECT_EQ(accepts(without(place)), !place.required) << place.where;
    EXPECT_EQ(place.schema.contains("default"), !place.required) << place.where;
  }
}

TEST(Schema, EveryDefaultIsWhatTheReaderTakesForAKeyLeftOut) {
  for (const Place& place : sampled_places()) {
    if (place.required || place.is_kind) continue;
    const auto left_out = read_text(without(place).dump(), "j");
    const auto written = read_text(with(place, place.schema["default"]).dump(), "j");
    ASSERT_TRUE(left_out && written) << place.where;
    EXPECT_EQ(left_out->config, written->config) << place.where;
    const bool one_valued = place.schema.contains("enum") && place.schema["enum"].size() == 1;
    const bool one_valued_map =
        place.schema.contains("properties") && place.schema["properties"].size() == 1 &&
        place.schema["properties"].begin()->value("enum", json()).size() == 1;
    if (one_valued || one_valued_map) continue;
    EXPECT_NE(left_out->config, config_of(place.config.dump()))
        << place.where << " has its default in the full config: this proves nothing";
  }
}

/// The next number beyond `limit`, of the key's type.
json beyond(const json& schema, const json& limit, int sign) {
  if (type_of(schema) == "integer") return limit.get<std::int64_t>() + sign;
  return std::nextafter(limit.get<double>(), sign * std::numeric_limits<double>::infinity());
}

TEST(Schema, EveryRangeIsTheReaders) {
  int numbers = 0;
  for (const Place& place : sampled_places()) {
    json schema = place.schema;
    json::json_pointer where = place.where;
    while (type_of(schema) == "array") {
      schema = json(schema["items"]);
      where = where / 0;
    }
    if (type_of(schema) != "number" && type_of(schema) != "integer") continue;
    ++numbers;
    const Place number{schema, where, place.config};
    ASSERT_TRUE(schema.contains("maximum")) << where << ": every number has both ends";
    EXPECT_TRUE(accepts(with(number, schema["maximum"]))) << where;
    EXPECT_FALSE(accepts(with(number, beyond(schema, schema["maximum"], 1)))) << where;
    const bool open = schema.contains("exclusiveMinimum");
    const json min = schema[open ? "exclusiveMinimum" : "minimum"];
    ASSERT_TRUE(min.is_number()) << where;
    EXPECT_EQ(accepts(with(number, min)), !open) << where;
    EXPECT_TRUE(accepts(with(number, open ? beyond(schema, min.get<double>() + 1e-300, 1) : min)))
        << where;
    EXPECT_FALSE(accepts(with(number, beyond(schema, min, -1)))) << where;
  }
  EXPECT_GT(numbers, 150 / kOneIn);
}

TEST(Schema, EveryTypeIsTheReaders) {
  const std::vector<std::pair<std::string, json>> samples = {
      {"object", json::object({{"no_such_key", 1}})},
      {"array", json::parse("[[[]]]")},
      {"string", "no such word"},
      {"boolean", true}};
  for (const Place& place : sampled_places()) {
    for (const auto& [type, sample] : samples) {
      if (type == "boolean" && type_of(place.schema) == "boolean") continue;
      if (type == "string" && type_of(place.schema) == "string" && !place.schema.contains("enum") &&
          !place.schema.contains("pattern")) {
        continue;
      }
      EXPECT_FALSE(accepts(with(place, sample))) << place.where << " takes " << sample;
    }
    EXPECT_EQ(accepts(with(place, nullptr)), is_nullable(place.schema)) << place.where;
  }
}

TEST(Schema, EveryWordOfAnEnumerationIsTaken) {
  for (const Place& place : all_places()) {
    if (!place.schema.contains("enum")) continue;
    for (const json& word : place.schema["enum"])
      EXPECT_TRUE(accepts(with(place, word))) << place.where << word;
  }
}

TEST(Schema, EveryListLengthIsTheReaders) {
  for (const Place& place : sampled_places()) {
    if (type_of(place.schema) != "array") continue;
    const json item = place.config[place.where][0];
    const auto list = [&](std::size_t count) { return with(place, json(count, item)); };
    const std::size_t min = place.schema.value("minItems", std::size_t{0});
    const std::size_t max = place.schema.at("maxItems");
    EXPECT_TRUE(accepts(list(min))) << place.where;
    EXPECT_EQ(accepts(list(min > 0 ? min - 1 : 0)), min == 0) << place.where;
    if (max > 20) continue;  // longer than a file may be
    EXPECT_TRUE(accepts(list(max))) << place.where;
    EXPECT_FALSE(accepts(list(max + 1))) << place.where;
  }
}

TEST(Schema, GainsAreANumberAListOrAMatrixAndNothingElse) {
  int found = 0;
  for (const Place& place : all_places()) {
    if (!is_gains(place.schema)) continue;
    ++found;
    for (const char* sound : {"1", "[1]", "[1, -2]", "[[1, 2], [3, 4]]"})
      EXPECT_TRUE(accepts(with(place, json::parse(sound)))) << place.where << sound;
    for (const char* wrong :
         {"[]", "[[]]", "[[[1]]]", "[1, [2]]", "[[1], 2]", "{}", "true", "[true]"})
      EXPECT_FALSE(accepts(with(place, json::parse(wrong)))) << place.where << wrong;
    const json max = place.schema["maximum"];
    EXPECT_FALSE(accepts(with(place, json::array({beyond(place.schema, max, 1)})))) << place.where;
  }
  EXPECT_EQ(found, 2);
}

TEST(Schema, NoMapTakesOtherKeys) {
  std::function<void(const json&)> check = [&](const json& schema) {
    if (schema.contains("properties")) {
      EXPECT_EQ(schema["additionalProperties"], false);
      for (const auto& [key, sub] : schema["properties"].items()) check(sub);
    }
    if (schema.contains("items")) check(schema["items"]);
  };
  const json schema = json::parse(json_schema());
  EXPECT_EQ(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
  check(schema);
}

}  // namespace
}  // namespace hapticd::config::test
