// A small config, and what the tests ask of errors.
#pragma once
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "config/compile.h"

namespace hapticd::config::test {

/// One simulated axis, one wall; sound.
inline const std::string kSmall = R"(version: 1
loop: {rate_Hz: 1000}
devices:
  - name: left
    driver: sim
    kinematics: {cartesian: {directions: [x]}}
    latency_s: 0
    axes:
      - name: x
        encoder: {counts_per_m: 163840, bits: 32}
        actuator: {max_force_N: 8}
        model: {mass_kg: 0.05, damping_Ns_m: 1.37, damping_uncertainty: 0.2}
scene:
  - plane: {name: wall, normal: [1, 0, 0], stiffness_N_m: 1000}
guard: {max_force_N: 6}
)";

inline std::string source_path(const std::string& path) {
  return std::string(HAPTICD_SOURCE_DIR) + "/" + path;
}

inline std::string file_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

/// `text` with the first `from` replaced; the test fails if there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << "the test's own text has no " << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

inline std::string listed(const std::vector<ConfigError>& errors) {
  std::string text;
  for (const ConfigError& error : errors) text += to_string(error) + "\n";
  return text;
}

/// Errors of reading and, if there are none, of compiling.
inline std::vector<ConfigError> errors_of(const std::string& text) {
  const auto compiled = read_text(text, "test.yaml").and_then(compile);
  return compiled ? std::vector<ConfigError>{} : compiled.error();
}

/// The config of a text that must be sound.
inline Config config_of(const std::string& text) {
  auto document = read_text(text, "test.yaml");
  EXPECT_TRUE(document) << listed(document ? std::vector<ConfigError>{} : document.error());
  return document ? document->config : Config{};
}

inline Compiled compiled_of(const std::string& text) {
  auto compiled = read_text(text, "test.yaml").and_then(compile);
  EXPECT_TRUE(compiled) << listed(compiled ? std::vector<ConfigError>{} : compiled.error());
  return compiled ? std::move(*compiled) : Compiled{};
}

/// One of the shipped examples; it must be sound.
inline Compiled example(const std::string& name) {
  auto compiled = load(source_path("config/examples/" + name));
  EXPECT_TRUE(compiled) << listed(compiled ? std::vector<ConfigError>{} : compiled.error());
  return compiled ? std::move(*compiled) : Compiled{};
}

/// Exactly one error, at this place ("line:column"), with this path and these words in its message.
inline void expect_error(const std::string& text, const std::string& place, const std::string& path,
                         const std::vector<std::string>& words) {
  const auto errors = errors_of(text);
  ASSERT_EQ(errors.size(), 1U) << listed(errors) << text.substr(0, 2000);
  const ConfigError& error = errors[0];
  EXPECT_EQ(error.file, "test.yaml");
  EXPECT_EQ(std::to_string(error.line) + ":" + std::to_string(error.column), place)
      << to_string(error);
  EXPECT_EQ(error.path, path) << to_string(error);
  for (const std::string& word : words) {
    EXPECT_NE(error.message.find(word), std::string::npos)
        << to_string(error) << "\nhas no: " << word;
  }
}

}  // namespace hapticd::config::test
