// Short names for texts.
#pragma once
#include <string>
#include <string_view>

namespace hapticd::config {

/// 16 hexadecimal digits, FNV-1a 64 (Fowler, Noll, Vo): tells texts apart, and is no protection
/// against forgery.
std::string digest_of(std::string_view text);

/// Of all lines but the one that begins with "digest:": what a designed coupling file says of
/// itself in that line.
std::string digest_of_rest(std::string_view text);

}  // namespace hapticd::config
