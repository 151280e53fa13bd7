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
      "axes": [{"mass_kg": 1, "inertia_kgm2": 1, "damping_Ns_m": 2, "damping_Nms_rad": 2, "coulomb_N": 0.1,
                "coulomb_Nm": 0.1, "delay_s": 0.001, "position_m": 0.1, "position_rad": 0.1, "noise_counts": 1,
                "dac_step_N": 0.01, "dac_step_Nm": 0.01, "relative": true, "index_m": 0.1, "index_rad": 0.1,
                "stops_m": [-1, 1], "stops_rad": [-1, 1], "homed_at_s": 1}],
      "linkage": {"inner_link_kg": 1, "outer_link_kg": 2, "tip_kg": 3, "gravity_m_s2": [0, 0, -9]},
      "hand": {"mass_kg": 1, "stiffness_N_m": 2, "damping_Ns_m": 3, "direction": [0, 1, 0],
               "script": [{"at_s": 1, "force_N": 2, "position_m": 0.3}]},
      "force_sensor": {"noise_N": 0.1},
      "substeps": 5, "seed": 9,
      "digital": [{"at_s": 1, "bits": 3}],
      "failures": [{"kind": "jump", "axis": "x", "at_s": 1, "for_s": 2, "size_m": 0.1, "size_rad": 0.1}]},
    "kinematics": {"cartesian": {"directions": ["y"]}},
    "pose": {"position_m": [1, 2, 3], "rotation_quaternion": [0, 1, 0, 0]},
    "workspace_scale": 2,
    "axes": [{"name": "x", "kind": "rotary",
              "encoder": {"counts_per_m": 1000, "counts_per_rev": 1000, "bits": 20, "offset_m": 0.1,
                          "offset_rad": 0.1, "reversed": true, "stuck_s": 1},
              "actuator": {"max_force_N": 9, "max_torque_Nm": 9, "continuous_force_N": 3,
                           "continuous_torque_Nm": 3, "thermal_time_s": 20},
              "model": {"mass_kg": 1, "inertia_kgm2": 1, "damping_Ns_m": 2, "damping_Nms_rad": 2,
                        "coulomb_N": 0.1, "coulomb_Nm": 0.1, "mass_uncertainty": 0.1, "damping_uncertainty": 0.2},
              "velocity": {"estimator": "foaw", "cutoff_Hz": 100, "window": 9, "degree": 3, "noise_counts": 2,
                           "bandwidth_rad_s": 700},
              "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
                           "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1,
                           "extra_delay_ticks": 1, "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1,
                           "i_know_it_cancels_the_hand": true},
              "compensation": {"viscous_share": 0.1, "coulomb_share": 0.1, "smooth_m_s": 0.1,
                               "smooth_rad_s": 0.1, "gravity_N": 1, "gravity_Nm": 1, "swing_Nm": 1,
                               "swing_phase_rad": 1},
              "homing": {"by": "index", "position_m": 0.1, "position_rad": 0.1, "search_force_N": 1,
                         "search_torque_Nm": 1, "search_velocity_m_s": 0.1, "search_velocity_rad_s": 0.1,
                         "still_s": 0.1, "timeout_s": 5},
              "travel": {"min_m": -1, "max_m": 1, "min_rad": -1, "max_rad": 1, "stiffness_N_m": 10,
                         "stiffness_Nm_rad": 10, "margin_m": 0.1, "margin_rad": 0.1, "max_force_N": 1,
                         "max_torque_Nm": 1}}],
    "contact": {
      "x": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}},
      "y": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}},
      "z": {"model": {"mass_kg": 1, "damping_Ns_m": 2}, "observer": {"mode": "model", "order": 1, "cutoff_Hz": 5, "nominal_mass_kg": 1,
        "nominal_inertia_kgm2": 1, "nominal_damping_Ns_m": 1, "nominal_damping_Nms_rad": 1, "extra_delay_ticks": 1,
        "blend_s": 1, "max_force_N": 1, "max_torque_Nm": 1, "i_know_it_cancels_the_hand": true}}},
    "gravity": {"tip_mass_kg": 1, "acceleration_m_s2": [0, 0, -9]},
    "force_sensor": {"directions": ["x"]},
    "enable_inputs": [{"bit": 1, "active": false, "role": "estop"}],
    "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_velocity_rad_s": 2, "max_slew_N_s": 3, "ramp_s": 4,
              "max_stale_ticks": 5, "max_power_W": 6, "workspace": {"min_m": [-1, -1, -1], "max_m": [1, 1, 1]},
              "passivity_controller": {"budget_J": 0.1, "damping_share": 0.1, "leak_s": 1}}}],
  "scene": [{"plane": {"name": "w", "devices": ["a"], "normal": [0, 1, 0], "offset_m": 0.2, "stiffness_N_m": 3,
                       "damping_Ns_m": 0.1}}],
  "stability": {"require": "none"},
  "guard": {"max_force_N": 1, "max_velocity_m_s": 2, "max_velocity_rad_s": 2, "max_slew_N_s": 3, "ramp_s": 4,
              "max_stale_ticks": 5, "max_power_W": 6, "workspace": {"min_m": [-1, -1, -1], "max_m": [1, 1, 1]},
              "passivity_controller": {"budget_J": 0.1, "damping_share": 0.1, "leak_s": 1}},
  "control": {"socket": "/tmp/s"},
  "telemetry": {"flight_dir": "/tmp", "flight_s": 2, "record": "/tmp/r"}
})");

/// The kinds of kinematics that kFull does not have, in full.
const json kOtherKinds = json::parse(R"({
  "five_bar": {"link_m": 0.2, "base_m": 0.1},
  "delta": {"a_m": 1, "b_m": 1, "c_m": 1, "d_m": 1, "e_m": 1, "f_m": 1, "r_m": 1, "s_m": 1,
            "legs_deg": [0, 120, 240], "home_m": [0, 0, 1]},
  "serial": {"joints": [{"theta_rad": 1, "d_m": 1, "a_m": 1, "alpha_rad": 1, "prismatic": true, "mass_kg": 1,
                         "center_m": [1, 1, 1]}]}
})");

/// One key of the schema, and where it stands in a config that has it.
struct Place {
  json schema;
  json::json_pointer where;
  json config;  ///< kFull, with another kind where the key belongs to that
  bool required = false;
  bool is_kind = false;  ///< the one key of a map that names a kind
};

std::string type_of(const json& schema) {
  return schema["type"].is_array() ? schema["type"][0].get<std::string>()
                                   : schema["type"].get<std::string>();
}

/// `config` with the kind `key` at `where`.
json with_kind(json config, const json::json_pointer& where, const std::string& key) {
  if (!config[where].contains(key)) config[where] = json{{key, kOtherKinds.at(key)}};
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
  for (const Place& place : all_places()) {
    if (place.is_kind) continue;
    EXPECT_EQ(accepts(without(place)), !place.required) << place.where;
    EXPECT_EQ(place.schema.contains("default"), !place.required) << place.where;
  }
}

TEST(Schema, EveryDefaultIsWhatTheReaderTakesForAKeyLeftOut) {
  for (const Place& place : all_places()) {
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
  for (const Place& place : all_places()) {
    json schema = place.schema;
    json::json_pointer where = place.where;
    if (type_of(schema) == "array" && type_of(schema["items"]) == "number") {
      schema = schema["items"];
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
  EXPECT_GT(numbers, 150);
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
