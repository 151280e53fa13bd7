// The word that somebody meant.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace hapticd::config {

/// Insertions, deletions, substitutions and swaps of neighbours that turn one into the other; a
/// change of case alone costs nothing.
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The word nearest to `found`, if it is near enough to be meant; else "".
std::string nearest(std::string_view found, const std::vector<std::string>& words);

}  // namespace hapticd::config
