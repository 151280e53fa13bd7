#include "config/text_check.h"

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "config/yaml_tree.h"

namespace hapticd::config {
namespace {

constexpr std::size_t kMaxQuotedBytes = 40;

using Byte = unsigned char;

bool is_continuation(std::string_view text, std::size_t at) {
  return at < text.size() && (static_cast<Byte>(text[at]) & 0xC0U) == 0x80U;
}

struct Sequence {
  std::size_t bytes = 0;
  std::uint32_t smallest = 0;  ///< code point that needs this many bytes
};

/// By the first byte; 0 bytes: none starts like this.
Sequence sequence_of(Byte first) {
  if (first < 0x80) return {1, 0};
  if (first >= 0xC2 && first < 0xE0) return {2, 0x80};
  if (first >= 0xE0 && first < 0xF0) return {3, 0x800};
  if (first >= 0xF0 && first < 0xF5) return {4, 0x10000};
  return {};
}

/// Bytes of the UTF-8 character at `at`; 0: there is none.
std::size_t character_bytes(std::string_view text, std::size_t at) {
  const auto first = static_cast<Byte>(text[at]);
  const Sequence sequence = sequence_of(first);
  if (sequence.bytes <= 1) return sequence.bytes;
  std::uint32_t code = first & (0xFFU >> (sequence.bytes + 1));
  for (std::size_t i = 1; i < sequence.bytes; ++i) {
    if (!is_continuation(text, at + i)) return 0;
    code = (code << 6U) | (static_cast<Byte>(text[at + i]) & 0x3FU);
  }
  const bool surrogate = code >= 0xD800 && code < 0xE000;
  return code < sequence.smallest || code > 0x10FFFF || surrogate ? 0 : sequence.bytes;
}

std::string hexadecimal(char byte) {
  constexpr std::string_view digits = "0123456789abcdef";
  const auto value = static_cast<Byte>(byte);
  return {'0', 'x', digits[value >> 4U], digits[value & 15U]};
}

bool is_control(char c) {
  return (static_cast<Byte>(c) < 0x20 && c != '\t' && c != '\n' && c != '\r') || c == 0x7F;
}

/// What is wrong with the character at `at`; empty: nothing.
std::string problem_at(std::string_view text, std::size_t at, bool indentation) {
  const char c = text[at];
  if (c == '\0') return "NUL byte: this is not a text file, or not UTF-8; save it as UTF-8 text";
  if (is_control(c)) return "control character " + hexadecimal(c) + "; remove it";
  if (c == '\r' && (at + 1 == text.size() || text[at + 1] != '\n')) {
    return "carriage return without line feed; end lines with LF or CR LF";
  }
  if (c == '\t' && indentation) return "tab used as indentation; YAML wants spaces";
  if (character_bytes(text, at) == 0)
    return "byte " + hexadecimal(c) + " is not UTF-8; save the file as UTF-8 text";
  return {};
}

}  // namespace

ConfigError first_text_problem(const std::string& text, const std::string& file) {
  if (text.size() > kMaxTextBytes) {
    return {
        .file = file,
        .message =
            "a config has at most 1 MiB, this has more; keep measured data in files of their own"};
  }
  int line = 1;
  std::size_t line_start = 0;
  bool indentation = true;
  for (std::size_t at = 0; at < text.size(); at += character_bytes(text, at)) {
    std::string problem = problem_at(text, at, indentation);
    if (!problem.empty()) {
      return {.file = file,
              .line = line,
              .column = static_cast<int>(at - line_start) + 1,
              .message = problem};
    }
    indentation = indentation && text[at] == ' ';
    if (text[at] == '\n') {
      ++line;
      line_start = at + 1;
      indentation = true;
    }
  }
  return {};
}

std::string quote(const std::string& text) {
  std::string shown = "'";
  std::size_t at = 0;
  while (at < text.size() && at < kMaxQuotedBytes) {
    const std::size_t bytes = character_bytes(text, at);
    if (bytes == 0 || is_control(text[at]) || text[at] == '\n' || text[at] == '\r' ||
        text[at] == '\t') {
      shown += hexadecimal(text[at]);
      ++at;
    } else {
      shown += text.substr(at, bytes);
      at += bytes;
    }
  }
  return shown + (at < text.size() ? "...'" : "'");
}

}  // namespace hapticd::config
