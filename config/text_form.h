// Forms that a text of the config may have to be of.
#pragma once
#include <string_view>

#include "config/key.h"

namespace hapticd::config {

bool has_form(std::string_view text, TextForm form);
/// For an error: "a name: a to z first, then a to z, 0 to 9 and _".
const char* expected_text(TextForm form);
/// Of the JSON schema; nullptr: any text.
const char* pattern_of(TextForm form);

}  // namespace hapticd::config
