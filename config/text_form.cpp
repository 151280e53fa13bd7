#include "config/text_form.h"

#include <algorithm>
#include <string>

namespace hapticd::config {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_hex_digit(char c) {
  return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F');
}

bool is_name(std::string_view text) {
  const auto is_letter = [](char c) { return c >= 'a' && c <= 'z'; };
  const auto is_rest = [&](char c) { return is_letter(c) || is_digit(c) || c == '_'; };
  return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), is_rest);
}

/// left, or left.x
bool is_coordinate(std::string_view text) {
  const std::size_t dot = text.find('.');
  if (dot == std::string_view::npos) return is_name(text);
  const std::string_view direction = text.substr(dot + 1);
  return is_name(text.substr(0, dot)) && (direction == "x" || direction == "y" || direction == "z");
}

bool is_hex(std::string_view text, std::size_t digits) {
  return text.size() == digits && std::all_of(text.begin(), text.end(), is_hex_digit);
}

bool is_hex_pair(std::string_view text) {
  return text.size() == 9 && text[4] == ':' && is_hex(text.substr(0, 4), 4) &&
         is_hex(text.substr(5), 4);
}

/// Takes digits off the front.
bool take_number(std::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), is_digit);
  const auto digits = static_cast<std::size_t>(end - text.begin());
  text.remove_prefix(digits);
  return digits > 0;
}

/// 1-2.3: a bus, and the ports on the way.
bool is_usb_port(std::string_view text) {
  if (!take_number(text) || !text.starts_with('-')) return false;
  do {
    text.remove_prefix(1);
    if (!take_number(text)) return false;
  } while (text.starts_with('.'));
  return text.empty();
}

}  // namespace

bool has_form(std::string_view text, TextForm form) {
  switch (form) {
    case TextForm::any:
      return true;
    case TextForm::name:
      return is_name(text);
    case TextForm::coordinate:
      return is_coordinate(text);
    case TextForm::hex_pair:
      return is_hex_pair(text);
    case TextForm::usb_port:
      return is_usb_port(text);
    case TextForm::sha256:
      return is_hex(text, 64);
  }
  return false;
}

const char* expected_text(TextForm form) {
  switch (form) {
    case TextForm::any:
      return "a text";
    case TextForm::name:
      return "a name: a to z first, then a to z, 0 to 9 and _";
    case TextForm::coordinate:
      return "a name, such as left, or one with a direction: left.x";
    case TextForm::hex_pair:
      return "two numbers of four hexadecimal digits, such as 1209:ffb0";
    case TextForm::usb_port:
      return "a bus and ports, such as 1-2 or 1-2.3";
    case TextForm::sha256:
      return "64 hexadecimal digits";
  }
  return "a text";
}

const char* pattern_of(TextForm form) {
  switch (form) {
    case TextForm::any:
      break;
    case TextForm::name:
      return "^[a-z][a-z0-9_]*$";
    case TextForm::coordinate:
      return "^[a-z][a-z0-9_]*([.][xyz])?$";
    case TextForm::hex_pair:
      return "^[0-9a-fA-F]{4}:[0-9a-fA-F]{4}$";
    case TextForm::usb_port:
      return "^[0-9]+-[0-9]+([.][0-9]+)*$";
    case TextForm::sha256:
      return "^[0-9a-fA-F]{64}$";
  }
  return nullptr;
}

}  // namespace hapticd::config
