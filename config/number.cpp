#include "config/number.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>

namespace hapticd::config {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

/// The text without its sign.
std::string_view magnitude(std::string_view text) {
  if (!text.empty() && (text[0] == '-' || text[0] == '+')) text.remove_prefix(1);
  return text;
}

std::size_t take_digits(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  const auto count = static_cast<std::size_t>(end - text.begin());
  text.remove_prefix(count);
  return count;
}

bool take_exponent(std::string_view& text) {
  if (text.empty() || (text[0] != 'e' && text[0] != 'E')) return true;
  text = magnitude(text.substr(1));
  return take_digits(text) > 0;
}

/// [-+] digits [. digits] [e [-+] digits], with a digit before or after the point.
bool is_decimal(std::string_view text) {
  text = magnitude(text);
  std::size_t digits = take_digits(text);
  if (!text.empty() && text[0] == '.') {
    text.remove_prefix(1);
    digits += take_digits(text);
  }
  return digits > 0 && take_exponent(text) && text.empty();
}

bool is_prefixed(std::string_view text) {
  text = magnitude(text);
  if (text.size() < 3 || text[0] != '0') return false;
  const char base = lower_case(text[1]);
  if (base != 'x' && base != 'o' && base != 'b') return false;
  return std::all_of(text.begin() + 2, text.end(), [](char c) {
    return is_digit(c) || (lower_case(c) >= 'a' && lower_case(c) <= 'f');
  });
}

bool has_leading_zero(std::string_view text) {
  text = magnitude(text);
  return text.size() > 1 && text[0] == '0' && is_digit(text[1]);
}

/// Not finite by name: .nan, inf, -.Inf, infinity.
std::string_view non_finite_name(std::string_view text) {
  text = magnitude(text);
  if (!text.empty() && text[0] == '.') text.remove_prefix(1);
  std::string word(text.substr(0, 9));
  std::transform(word.begin(), word.end(), word.begin(), lower_case);
  if (word == "nan") return "NaN";
  if (word == "inf" || word == "infinity") return "infinity";
  return {};
}

bool is_decimal_with_comma(std::string_view text) {
  if (std::count(text.begin(), text.end(), ',') != 1) return false;
  std::string with_point(text);
  std::replace(with_point.begin(), with_point.end(), ',', '.');
  return is_decimal(with_point);
}

/// What is wrong with a text that is not a plain decimal number; empty: nothing more than that.
std::string hint(std::string_view text) {
  if (is_prefixed(text))
    return "octal, hexadecimal and binary numbers are not taken; write it in decimal";
  if (const std::string_view name = non_finite_name(text); !name.empty()) {
    return std::string(name) + " is not taken; every number is finite";
  }
  if (is_decimal_with_comma(text)) return "the decimal sign is a point";
  return {};
}

std::string leading_zero_hint() {
  return "a leading zero would make it octal for other readers; write it without";
}

/// from_chars knows no leading plus.
std::string_view without_plus(std::string_view text) {
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  return text;
}

std::string text_of(const char* begin, std::to_chars_result result) {
  return {begin, static_cast<const char*>(result.ptr)};
}

}  // namespace

tl::expected<double, std::string> parse_real(std::string_view text) {
  if (!is_decimal(text)) return tl::unexpected(hint(text));
  if (has_leading_zero(text)) return tl::unexpected(leading_zero_hint());
  const std::string_view digits = without_plus(text);
  double value = 0;
  const auto result = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (result.ec != std::errc()) return tl::unexpected(std::string("no double can hold it"));
  return value;
}

tl::expected<std::int64_t, std::string> parse_whole(std::string_view text) {
  if (!is_decimal(text)) return tl::unexpected(hint(text));
  if (has_leading_zero(text)) return tl::unexpected(leading_zero_hint());
  const std::string_view digits = without_plus(text);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc::result_out_of_range)
    return tl::unexpected(std::string("it is too large"));
  if (error != std::errc() || end != digits.data() + digits.size()) {
    return tl::unexpected(std::string("a whole number has neither point nor exponent"));
  }
  return value;
}

bool looks_like_number(std::string_view text) {
  return is_decimal(text) || is_prefixed(text) ||
         (!text.empty() && magnitude(text).starts_with('.') && !non_finite_name(text).empty());
}

std::string format_number(double value) {
  std::array<char, 40> text{};
  return text_of(text.data(), std::to_chars(text.data(), text.data() + text.size(), value,
                                            std::chars_format::general, 6));
}

std::string format_exact(double value) {
  std::array<char, 40> text{};
  const double size = std::abs(value);
  const bool is_plain = size == 0 || (size >= 1e-4 && size < 1e15);  // 100000 rather than 1e+05
  return text_of(text.data(),
                 std::to_chars(text.data(), text.data() + text.size(), value,
                               is_plain ? std::chars_format::fixed : std::chars_format::general));
}

}  // namespace hapticd::config
