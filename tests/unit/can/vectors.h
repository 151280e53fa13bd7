// Test vectors of the CAN codecs: tests/data/can/vectors.json, or another file of that format named by
// HAPTICD_CAN_VECTORS.
#pragma once
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "drivers/can/frame.h"

namespace hapticd::can {

using Json = nlohmann::json;

inline const Json& vectors() {
  static const Json all = [] {
    const char* other = std::getenv("HAPTICD_CAN_VECTORS");
    const std::string path =
        other != nullptr ? other : HAPTICD_SOURCE_DIR "/tests/data/can/vectors.json";
    std::ifstream file(path);
    if (!file) throw std::runtime_error("cannot read " + path);
    return Json::parse(file);
  }();
  return all;
}

/// ".nan" and ".inf" stand for what JSON has no number for.
inline double number(const Json& value) {
  if (value.is_number()) return value.get<double>();
  const auto text = value.get<std::string>();
  if (text == ".nan") return std::nan("");
  return text == "-.inf" ? -INFINITY : INFINITY;
}

inline std::vector<std::uint8_t> bytes(const std::string& hex) {
  std::vector<std::uint8_t> all;
  for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
    all.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(i, 2), nullptr, 16)));
  return all;
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

inline bool flag(const Json& vector, const char* key) {
  return vector.value(key, false);
}

/// Of a vector that is to be decoded.
inline Frame frame_of(const Json& vector) {
  Frame frame{.id = vector.at("can_id").get<std::uint32_t>(),
              .extended = flag(vector, "extended"),
              .remote = flag(vector, "rtr"),
              .error = flag(vector, "error"),
              .fd = flag(vector, "fd")};
  const std::vector<std::uint8_t> data = bytes(vector.at("data").get<std::string>());
  frame.size = vector.value("len", static_cast<std::uint8_t>(data.size()));
  std::copy(data.begin(), data.end(), frame.data.begin());
  return frame;
}

/// A frame that was encoded, against its vector.
inline void expect_frame(const Frame& frame, const Json& vector) {
  EXPECT_EQ(frame.id, vector.at("can_id").get<std::uint32_t>());
  EXPECT_EQ(frame.extended, flag(vector, "extended"));
  EXPECT_EQ(frame.remote, flag(vector, "rtr"));
  EXPECT_EQ(frame.fd, flag(vector, "fd"));
  EXPECT_EQ(frame.fast, flag(vector, "brs"));
  const std::string shorter = vector.value("also_accept_len_4", "");
  if (!shorter.empty() && frame.size == 4) {
    EXPECT_EQ(hex(frame.payload()), shorter);
    return;
  }
  EXPECT_EQ(hex(frame.payload()), vector.at("data").get<std::string>());
  if (vector.contains("len")) {
    EXPECT_EQ(frame.size, vector.at("len").get<int>());
  }
}

}  // namespace hapticd::can
