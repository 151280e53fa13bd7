// What must hold of a text before any parser sees it.
#pragma once
#include <string>

#include "config/error.h"

namespace hapticd::config {

/// The first thing wrong: too long, empty, not UTF-8, control characters, tabs as indentation.
/// `message` empty: nothing.
ConfigError first_text_problem(const std::string& text, const std::string& file);

/// At most 40 bytes of it, printable, in quotes: for error messages.
std::string quote(const std::string& text);

}  // namespace hapticd::config
