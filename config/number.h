// Numbers between text and machine, the same in every locale.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <tl/expected.hpp>

namespace hapticd::config {

/// A decimal number, finite: "-1.5e-3". The error says what is wrong, for a person ("NaN is not
/// ...").
tl::expected<double, std::string> parse_real(std::string_view text);
/// A decimal whole number without point, exponent, leading zero.
tl::expected<std::int64_t, std::string> parse_whole(std::string_view text);
/// Would a YAML reader take this unquoted text for a number?
bool looks_like_number(std::string_view text);

/// Six significant digits, the shortest form: "0.001", "1e+09".
std::string format_number(double value);
/// All digits that are needed to get the same number back.
std::string format_exact(double value);

}  // namespace hapticd::config
