// Words for options out of range: what was expected, what was found.
#pragma once
#include <array>
#include <charconv>
#include <cmath>
#include <string>
#include <string_view>

namespace hapticd::sim {

inline std::string text(double value) {
  std::array<char, 32> digits;
  const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return {digits.data(), end};
}

inline std::string expected(std::string_view name, std::string_view what, double found) {
  return std::string(name) + ": expected " + std::string(what) + ", found " + text(found);
}

struct Field {
  std::string_view name;
  double value;
};

/// The first that is no finite number >= 0; empty: none.
template <class Fields>
std::string first_negative(const Fields& fields) {
  for (const Field& field : fields) {
    if (!std::isfinite(field.value) || field.value < 0) {
      return expected(field.name, "a number >= 0", field.value);
    }
  }
  return {};
}

inline bool positive(double value) {
  return std::isfinite(value) && value > 0;
}

/// The first that is no finite number; empty: none.
template <class Fields>
std::string first_not_finite(const Fields& fields) {
  for (const Field& field : fields)
    if (!std::isfinite(field.value)) return expected(field.name, "a number", field.value);
  return {};
}

}  // namespace hapticd::sim
