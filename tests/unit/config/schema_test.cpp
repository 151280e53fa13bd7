// The JSON schema and the man page are up to date, and what the schema says is what the reader
// does.
#include <cmath>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "config/json_schema.h"
#include "config/man_keys.h"
#include "tests/unit/config/support.h"

namespace hapticd::config::test {
namespace {

using nlohmann::json;

/// Every key that there is, each with a value that is not its default. JSON is YAML, so the reader
/// takes it.
const json kFull = json::parse(R"({
  "version": 1,
  "loop": {"rate_Hz": 500, "priority": 10, "cpu": 1, "max_gap_ticks": 7, "max_missed_per_s": 8},
  "start": {"enable": "when_ready"},
  "devices": [{
    "name": "a", "driver": "sim", "latency_s": 0.001,
    "sim": {
      "axes": [{"mass_kg": 1, "damping_Ns_m": 2, "coulomb_N": 0.1, "delay_s": 0.001, "position_m": 0.1,
                "noise_counts": 1, "dac_step_N": 0.01}],
      "hand": {"mass_kg": 1, "stiffness_N_m": 2, "damping_Ns_m": 3,
               "script": [{"at_s": 1, "force_N": 2, "position_m": 0.3}]},
      "substeps": 5, "seed": 9,
      "failures": [{"kind": "jump", "axis": "x", "at_s": 1, "for_s": 2, "size_m": 0.1}]},
    "kinematics": {"cartesian": {"directions": ["y"]}},
    "axes": [{"name": "x", "kind": "linear",
              "encoder": {"counts_per_m": 1000, "bits": 20, "offset_m": 0.1, "reversed": true, "stuck_s": 1},
              "actuator": {"max_force_N": 9},
              "model": {"mass_kg": 1, "damping_Ns_m": 2, "mass_uncertainty": 0.1, "damping_uncertainty": 0.2},
              "velocity": {"estimator": "backward_difference"}, "observer": {"mode": "off"}}],
    "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_slew_N_s": 3, "ramp_s": 4, "max_stale_ticks": 5}}],
  "scene": [{"plane": {"name": "w", "devices": ["a"], "normal": [0, 1, 0], "offset_m": 0.2, "stiffness_N_m": 3,
                       "damping_Ns_m": 0.1}}],
  "stability": {"require": "none"},
  "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_slew_N_s": 3, "ramp_s": 4, "max_stale_ticks": 5},
  "control": {"socket": "/tmp/s"},
  "telemetry": {"flight_dir": "/tmp", "flight_s": 2, "record": "/tmp/r"}
})");

/// One key of the schema, and where it stands in kFull.
struct Place {
  json schema;
  json::json_pointer where;
  bool required = false;
};

std::string type_of(const json& schema) {
  return schema["type"].is_array() ? schema["type"][0].get<std::string>()
                                   : schema["type"].get<std::string>();
}

void gather(const json& schema, const json::json_pointer& where, std::vector<Place>& places) {
  const std::string type = type_of(schema);
  if (type == "array") gather(schema["items"], where / 0, places);
  if (type != "object") return;
  const auto required = schema.value("required", std::vector<std::string>{});
  for (const auto& [key, sub] : schema["properties"].items()) {
    const bool is_required = std::find(required.begin(), required.end(), key) != required.end();
    places.push_back({sub, where / key, is_required});
    gather(sub, where / key, places);
  }
}

std::vector<Place> all_places() {
  std::vector<Place> places;
  gather(json::parse(json_schema()), json::json_pointer(), places);
  return places;
}

bool is_kind(const Place& place) {
  return place.where.parent_pointer().parent_pointer().to_string() == "/scene";
}

bool accepts(const json& config) {
  return read_text(config.dump(), "j").has_value();
}

json with(const Place& place, const json& value) {
  json config = kFull;
  config[place.where] = value;
  return config;
}

json without(const Place& place) {
  json config = kFull;
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
    if (is_kind(place)) continue;
    std::string key = place.where.back();
    for (std::size_t at = 0; (at = key.find('_', at)) != std::string::npos; at += 2)
      key.insert(at, "\\");
    EXPECT_NE(page.find("*" + key + "*: "), std::string::npos) << key;
  }
}

TEST(Schema, FullConfigHasEveryKeyAndIsAccepted) {
  ASSERT_TRUE(accepts(kFull)) << listed(read_text(kFull.dump(), "j").error());
  const auto places = all_places();
  EXPECT_GT(places.size(), 80U);
  for (const Place& place : places) EXPECT_TRUE(kFull.contains(place.where)) << place.where;
}

TEST(Schema, RequiredIsWhatTheReaderRequires) {
  for (const Place& place : all_places()) {
    if (is_kind(place)) continue;
    EXPECT_EQ(accepts(without(place)), !place.required) << place.where;
    EXPECT_EQ(place.schema.contains("default"), !place.required) << place.where;
  }
}

TEST(Schema, EveryDefaultIsWhatTheReaderTakesForAKeyLeftOut) {
  for (const Place& place : all_places()) {
    if (place.required || is_kind(place)) continue;
    const auto left_out = read_text(without(place).dump(), "j");
    const auto written = read_text(with(place, place.schema["default"]).dump(), "j");
    ASSERT_TRUE(left_out && written) << place.where;
    EXPECT_EQ(left_out->config, written->config) << place.where;
    const bool one_valued = place.schema.contains("enum") && place.schema["enum"].size() == 1;
    const bool one_valued_map =
        place.schema.contains("properties") && place.schema["properties"].size() == 1 &&
        place.schema["properties"].begin()->value("enum", json()).size() == 1;
    if (one_valued || one_valued_map) continue;
    EXPECT_NE(left_out->config, config_of(kFull.dump()))
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
  for (const Place& place : all_places()) {
    json schema = place.schema;
    json::json_pointer where = place.where;
    if (type_of(schema) == "array" && type_of(schema["items"]) == "number") {
      schema = schema["items"];
      where = where / 0;
    }
    if (type_of(schema) != "number" && type_of(schema) != "integer") continue;
    ++numbers;
    const Place number{schema, where};
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
  EXPECT_GT(numbers, 40);
}

TEST(Schema, EveryTypeIsTheReaders) {
  const std::vector<std::pair<std::string, json>> samples = {
      {"object", json::object({{"no_such_key", 1}})},
      {"array", json::array({json::array()})},
      {"string", "no such word"},
      {"boolean", true}};
  for (const Place& place : all_places()) {
    for (const auto& [type, sample] : samples) {
      if (type == "boolean" && type_of(place.schema) == "boolean") continue;
      if (type == "string" && type_of(place.schema) == "string" && !place.schema.contains("enum") &&
          !place.schema.contains("pattern")) {
        continue;
      }
      EXPECT_FALSE(accepts(with(place, sample))) << place.where << " takes " << sample;
    }
    const bool nullable = place.schema["type"].is_array();
    EXPECT_EQ(accepts(with(place, nullptr)), nullable) << place.where;
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
  for (const Place& place : all_places()) {
    if (type_of(place.schema) != "array") continue;
    const json item = kFull[place.where][0];
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
