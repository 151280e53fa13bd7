// What a key takes, in words: for error messages and the man page.
#pragma once
#include <string>

#include "config/describe.h"

namespace hapticd::config {

/// "from 10 to 20000 Hz", "above 0, at most 60 s", "" for no limit.
std::string range_text(const Key& key);
/// "1 to 3 entries", "at most 6 entries", "" for no limit.
std::string count_text(const Key& key);
/// Is `value` in the key's range?
bool in_range(double value, const Key& key);

}  // namespace hapticd::config
