// The vectors of the three protocols, for the emulated drives. HAPTICD_CAN_VECTORS names others.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sim/can/frame.h"

namespace hapticd::test::emulator {

using Json = nlohmann::json;

inline const Json& vectors() {
  static const Json read = [] {
    const char* other = std::getenv("HAPTICD_CAN_VECTORS");
    const std::string path =
        other != nullptr ? other : HAPTICD_SOURCE_DIR "/tests/data/can/vectors.json";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read the vectors in " + path);
    return Json::parse(file);
  }();
  return read;
}

inline std::vector<std::uint8_t> bytes_of(const std::string& hex) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return bytes;
}

inline std::string hex_of(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += kDigits[byte >> 4];
    hex += kDigits[byte & 15];
  }
  return hex;
}
inline std::string hex_of(const sim::can::Frame& frame) {
  return hex_of(sim::can::payload(frame));
}

inline double number_of(const Json& value) {
  return value.is_string() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

/// `data` in place of the vector's own, if not empty.
inline sim::can::Frame frame_of(const Json& vector, const std::string& data = {}) {
  sim::can::Frame frame{};
  frame.can_id = vector.at("can_id").get<std::uint32_t>();
  if (vector.value("extended", false)) frame.can_id |= CAN_EFF_FLAG;
  if (vector.value("rtr", false)) frame.can_id |= CAN_RTR_FLAG;
  if (vector.value("error", false)) frame.can_id |= CAN_ERR_FLAG;
  if (vector.value("fd", false)) frame.flags |= CANFD_FDF;
  if (vector.value("brs", false)) frame.flags |= CANFD_BRS;
  const auto bytes = bytes_of(data.empty() ? vector.at("data").get<std::string>() : data);
  std::copy(bytes.begin(), bytes.end(), frame.data);
  frame.len = static_cast<std::uint8_t>(bytes.size());
  if (data.empty()) frame.len = vector.value("len", frame.len);
  return frame;
}

/// Equal, or both NaN; to `step`.
inline void expect_near(double found, double expected, double step, const std::string& what) {
  if (std::isnan(expected)) {
    EXPECT_TRUE(std::isnan(found)) << what << " is " << found;
  } else {
    EXPECT_NEAR(found, expected, step) << what;
  }
}

}  // namespace hapticd::test::emulator
