// Test vectors of the USB codecs: tests/data/usb/vectors.json, or another file of that format named by
// HAPTICD_USB_VECTORS.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "drivers/hid/report_map.h"

namespace hapticd::usb {

using Json = nlohmann::json;
using Bytes = std::vector<std::uint8_t>;

/// Nothing: our own.
inline const char* other_vectors() {
  return std::getenv("HAPTICD_USB_VECTORS");
}

inline const Json& vectors() {
  static const Json all = [] {
    const std::string path = other_vectors() != nullptr ? other_vectors()
                                                        : HAPTICD_SOURCE_DIR
                                 "/tests/data/usb/vectors.json";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    return Json::parse(file);
  }();
  return all;
}

/// Runs `check` on each vector of a group, named where one fails. Our own file has some in each.
template <class Check>
void each_vector(const char* group, Check&& check) {
  const Json all = vectors().value(group, Json::array());
  EXPECT_TRUE(!all.empty() || other_vectors() != nullptr) << group;
  for (const Json& vector : all) {
    SCOPED_TRACE(std::string(group) + ": " + vector.value("name", vector.dump()));
    check(vector);
  }
}

inline Bytes bytes(const std::string& hex) {
  Bytes all;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    all.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return all;
}
inline Bytes bytes(const Json& vector, const char* key) {
  return bytes(vector.at(key).get<std::string>());
}

inline std::string hex(std::span<const std::uint8_t> data) {
  constexpr const char* kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : data) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

inline hid::Place place_of(const Json& field) {
  return {.offset_bits = field.at("bit_offset").get<std::uint32_t>(),
          .width_bits = field.at("bit_width").get<std::uint32_t>(),
          .is_signed = field.at("signed").get<bool>(),
          .endian = field.at("endian") == "big" ? hid::Endian::big : hid::Endian::little};
}
inline std::optional<std::uint8_t> report_id_of(const Json& vector) {
  if (!vector.contains("report_id") || vector.at("report_id").is_null()) return std::nullopt;
  return vector.at("report_id").get<std::uint8_t>();
}
inline hid::InputMap input_map_of(const Json& vector, std::size_t report_bytes) {
  hid::InputMap map{.report_id = report_id_of(vector), .report_bytes = report_bytes};
  for (const Json& field : vector.at("fields"))
    map.fields.push_back({.place = place_of(field),
                          .scale = field.at("scale").get<double>(),
                          .offset = field.at("offset").get<double>()});
  return map;
}
inline hid::OutputMap output_map_of(const Json& vector, std::size_t report_bytes) {
  hid::OutputMap map{.report_id = report_id_of(vector), .report_bytes = report_bytes};
  for (const Json& field : vector.at("fields"))
    map.fields.push_back({.place = place_of(field),
                          .scale = field.at("scale").get<double>(),
                          .offset = field.at("offset").get<double>()});
  return map;
}

/// Three int16 and a word.
inline hid::Place int16_at(std::uint32_t bit) {
  return {.offset_bits = bit, .width_bits = 16, .is_signed = true};
}
/// WoodenHaptics 1.5: counters a, b, c and a sequence number in; mA and a word without meaning out.
inline hid::InputMap woodenhaptics_in() {
  hid::InputMap map{.report_bytes = 8};
  for (std::uint32_t i = 0; i < 3; ++i)
    map.fields.push_back({.place = int16_at(16 * i), .modulus = 65536});
  map.sequence = hid::SequenceField{.place = {.offset_bits = 48, .width_bits = 16}};
  return map;
}
inline hid::OutputMap woodenhaptics_out() {
  hid::OutputMap map{.report_bytes = 8};
  for (std::uint32_t i = 0; i < 3; ++i)
    map.fields.push_back({.place = int16_at(16 * i), .scale = 0.001, .least = -3, .most = 3});
  return map;
}

}  // namespace hapticd::usb
