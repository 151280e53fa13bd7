// Bounds of a number on a command line. Unlike CLI::Range it refuses what is no number, and words the bounds as people do.
#pragma once
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <string>

namespace hapticd::daemon {

inline CLI::Validator within(double low, double high) {
  const auto check = [low, high](const std::string& text) -> std::string {
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    if (end != text.c_str() && *end == '\0' && value >= low && value <= high) return {};
    const auto words = [](double bound) {
      char number[32];
      std::snprintf(number, sizeof number, "%g", bound);
      return std::string(number);
    };
    return "expected " + words(low) + " to " + words(high) + ", found " + text;
  };
  return CLI::Validator(check, "");
}

}  // namespace hapticd::daemon
